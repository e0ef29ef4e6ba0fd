// Evolves a controller that maps ranges to speeds, so that eight robots cover a room. A (5 + 20) evolution
// strategy (5 parents, 20 children per generation) runs 1,000 trials of 30 s. Each trial resets the same
// world; a reset reads no file and allocates no memory.
#include <troupe/troupe.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <span>
#include <vector>

namespace {

constexpr std::size_t k_parents = 5, k_children = 20, k_trials = 1000, k_beams = 5;
constexpr double k_trial_s = 30, k_most_speed = 0.5, k_most_turn = 2;

/// The weights of the controller: one weight per beam and a bias for the forward speed, then one weight per
/// beam and a bias for the turn rate.
using Genome = std::array<double, 2 * (k_beams + 1)>;

struct Individual {
  Genome genome{};
  double fitness = 0;
};

troupe::WorldBuilder room() {
  troupe::WorldBuilder world;
  world.wall({-4, -3}, {4, -3}).wall({-4, 3}, {4, 3}).wall({-4.1, -3}, {-4.1, 3}).wall({4.1, -3}, {4.1, 3});
  world.wall({-1, -1}, {-1, 2}).wall({1.5, -2}, {1.5, 1});
  world.set("bounds_m", {{-4, -3}, {4, 3}});
  world.type("bot")
      .size(0.3, 0.3, 0.2)
      .drive("diff", {{"velocity_max_x_mps", k_most_speed}})
      .sensor(
          "ir", "ranger",
          {{"transducers", {troupe::Settings{{"range_max_m", 2}, {"fov_deg", 120}, {"samples", k_beams}}}}},
          {.z = 0.1});
  world.population("r", "bot", 8,
                   {{"rule", "grid"}, {"region_m", {{-3.5, -2.5}, {-3.2, 2.6}}}, {"pitch_m", 0.7}});
  return world;
}

void steer(const Genome& genome, std::span<const float> ranges, troupe::Model::Speed& speed) {
  const auto weigh = [&](const double* weights) {
    double sum = weights[k_beams];
    for (std::size_t b = 0; b < k_beams; ++b) sum += weights[b] * (1 - ranges[b] / 2);  // 0: free, 1: near
    return sum;
  };
  speed.forward = std::clamp(weigh(genome.data()), 0.0, 1.0) * k_most_speed;
  speed.turn = std::clamp(weigh(genome.data() + k_beams + 1), -1.0, 1.0) * k_most_turn;
}

/// Runs a trial with one genome from tick 0 and returns its fitness: the fraction of the room that the robots
/// have visited.
double run_trial(troupe::Simulation& simulation, troupe::Swarm& swarm, troupe::Measures& measures,
                 const Genome& genome) {
  std::vector<float> ranges(swarm.size() * k_beams);
  std::vector<troupe::Model::Speed> speeds(swarm.size());
  simulation.reset();
  while (simulation.time_s() < k_trial_s) {
    simulation.step();
    measures.see();
    swarm.ranges(ranges);
    for (std::size_t i = 0; i < swarm.size(); ++i)
      steer(genome, std::span(ranges).subspan(i * k_beams, k_beams), speeds[i]);
    swarm.set_speeds(speeds);
  }
  return measures.value("coverage");
}

}  // namespace

int main() {
  troupe::Simulation simulation(room(), {.threads = 1});
  troupe::Swarm swarm = simulation.swarm("bot");
  troupe::Measures measures(simulation, {R"({"kind": "coverage", "cell_m": 0.5})"});

  std::vector<Individual> parents;
  std::size_t trials = 0;
  for (std::uint32_t generation = 0; trials < k_trials; ++generation) {
    std::vector<Individual> all = parents;
    for (std::uint32_t child = 0; child < k_children && trials < k_trials; ++child, ++trials) {
      // The random numbers depend only on the generation and the child, so results are the same on every
      // machine.
      troupe::Random random(1, troupe::stream_id("evolution", "mutation"), child, generation);
      Individual individual;
      if (!parents.empty()) individual = parents[random.below(k_parents)];
      for (double& gene : individual.genome) gene += (parents.empty() ? 1 : 0.3) * random.normal();
      individual.fitness = run_trial(simulation, swarm, measures, individual.genome);
      all.push_back(individual);
    }
    std::ranges::stable_sort(all, std::greater(), &Individual::fitness);
    all.resize(k_parents);
    parents = std::move(all);
    if (generation % 10 == 0)
      std::printf("after %4zu trials: %.3f of the room\n", trials, parents.front().fitness);
  }
  const double again = run_trial(simulation, swarm, measures, parents.front().genome);
  std::printf("the best covers %.3f, state %016llx\n", again,
              static_cast<unsigned long long>(simulation.state_hash()));
  return again == parents.front().fitness ? 0 : 1;
}
