// A study in C++: measures the fraction of a room that 2 to 16 robots cover in one minute, for eight seeds.
// Each core makes one run at a time. The table is the same on any number of cores. (`troupe sweep` does this
// for any world, and continues where it was interrupted.)
#include <troupe/troupe.hpp>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <string>
#include <thread>
#include <vector>

namespace {

struct Run {
  std::size_t robots = 0;
  std::uint64_t seed = 0;
  double coverage = 0;
  double stalls = 0;
  std::uint64_t hash = 0;
  std::exception_ptr error;
};

void carry_out(Run& run, const char* world) {
  troupe::SimulationOptions options;
  options.threads = 1;  // the other cores run other simulations
  options.seed = run.seed;
  options.robots = {{"", run.robots}};
  troupe::Simulation simulation(world, options);
  troupe::Measures measures(simulation, {R"({"kind": "coverage", "cell_m": 0.5})", "stalls"});
  simulation.on_tick([&](troupe::Simulation&) { measures.see(); });
  simulation.run_for(60);
  run.coverage = measures.value("coverage");
  run.stalls = measures.value("stalls");
  run.hash = simulation.state_hash();
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<Run> runs;
  for (const std::size_t robots : {2, 4, 8, 16})
    for (std::uint64_t seed = 1; seed <= 8; ++seed) runs.push_back({.robots = robots, .seed = seed});

  const char* world = argc > 1 ? argv[1] : "room.json";
  const unsigned cores =
      argc > 2 ? static_cast<unsigned>(std::stoul(argv[2])) : std::thread::hardware_concurrency();
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> workers;
  for (unsigned core = 0; core < std::max(1u, cores); ++core)
    workers.emplace_back([&] {
      for (std::size_t r = next++; r < runs.size(); r = next++) {
        try {
          carry_out(runs[r], world);
        } catch (...) {
          runs[r].error = std::current_exception();
        }
      }
    });
  for (std::thread& worker : workers) worker.join();

  for (const Run& run : runs)
    if (run.error) std::rethrow_exception(run.error);
  std::puts("robots,seed,coverage,stalls,hash");
  for (const Run& run : runs)
    std::printf("%zu,%llu,%.4f,%.0f,%016llx\n", run.robots, static_cast<unsigned long long>(run.seed),
                run.coverage, run.stalls, static_cast<unsigned long long>(run.hash));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
