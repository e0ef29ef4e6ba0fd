#include "apps/check/check.hpp"

#include "apps/check/filled_storage.hpp"
#include "apps/messages.hpp"
#include "apps/numbers.hpp"
#include "apps/progress.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/observing/controller_check.hpp"
#include "engine/observing/measures.hpp"
#include "engine/observing/remade_world.hpp"
#include "engine/observing/state_difference.hpp"
#include "engine/spec/ticks.hpp"
#include "partition/job_thread.hpp"
#include "troupe/measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace troupe::apps {
namespace {

// Bytes with which FilledStorage fills new memory. Results that depend on uninitialised memory then differ.
// Variants are constructed with the two bytes in turn; decisions are repeated with the second byte.
constexpr std::array<std::byte, 2> k_fills{std::byte{0x5a}, std::byte{0xa5}};

/// What a variant does with the data of its world that are not part of the state, such as caches and the
/// spatial index.
enum class Memory : std::uint8_t {
  kept,       ///< keeps these data
  forgotten,  ///< discards these data after each tick: World::forget()
  remade,     ///< before each tick, replaces the world by a new one with the same state:
              ///< engine/observing/remade_world.hpp
  shuffled,   ///< after each tick, gives the bodies other rows (places in the state tables):
              ///< World::shuffle_rows()
};

/// One way to run the world. All variants must give the same results.
struct Variant {
  std::string name;
  Simulation simulation;
  engine::WorldOptions options;
  Memory memory = Memory::kept;
  std::unique_ptr<engine::World> remade = nullptr;  // if not null, replaces the simulation's world
  std::optional<Measures> measures = {};            // of the world; they refer to `simulation`
  bool differs = false;                             // from the first variant
  std::optional<std::string> error = {};            // text of the StepError that ended it

  engine::World& world() { return remade ? *remade : simulation.world(); }
  void step() {
    if (memory == Memory::remade) remade = engine::remade_world(world(), simulation.registry(), options);
    try {
      if (remade)
        remade->step();
      else
        simulation.step();
    } catch (const engine::StepError& stop) {
      error = stop.what();  // the state is incomplete: neither hashes nor differences can be computed
      return;
    }
    if (memory == Memory::forgotten) world().forget();
    if (memory == Memory::shuffled) world().shuffle_rows(1);
    if (measures) measures->see();
  }
};

std::string variant_name(unsigned ranks, unsigned threads, double tile_size_m) {
  return fmt::format("{}{}, {}", ranks == 1 ? "" : fmt::format("{} ranks, ", ranks),
                     counted(threads, "thread"),
                     tile_size_m > 0 ? fmt::format("tiles of {} m", tile_size_m) : "automatic tiles");
}

/// Returns the seed of the delays between ranks: the value of --rank-seed, or else 1, because `check` always
/// delays messages between ranks.
std::uint64_t rank_seed_of(const CheckOptions& options) { return options.simulation.rank_seed.value_or(1); }

/// Loads the world once for each variant.
std::vector<Variant> load(const CheckOptions& options, const engine::Registry& registry) {
  std::vector<Variant> variants;
  SimulationOptions simulation = with_environment(options.simulation);
  simulation.rank_seed = rank_seed_of(options);
  const std::shared_ptr<RankProcesses> processes = std::move(simulation.processes);
  simulation.processes = nullptr;
  const auto add = [&](unsigned threads, double tile_size_m, Memory memory,
                       std::string_view what) -> Variant& {
    simulation.tile_size_m = tile_size_m;
    simulation.threads = threads;
    const FilledStorage filled(k_fills[variants.size() % k_fills.size()]);
    variants.push_back({variant_name(simulation.ranks, threads, tile_size_m) + std::string(what),
                        Simulation(options.world, simulation, registry),
                        {threads, tile_size_m},
                        memory});
    return variants.back();
  };
  for (const unsigned ranks : options.ranks) {
    simulation.ranks = ranks;
    for (const double tile_size_m : options.tile_sizes_m)
      for (const unsigned threads : options.threads) add(threads, tile_size_m, Memory::kept, "");
  }
  simulation.ranks = 1;
  if (processes) {
    simulation.processes = processes;
    for (const unsigned threads : options.threads)
      add(threads, options.tile_sizes_m.front(), Memory::kept, ", all processes");
    simulation.processes = nullptr;
  }
  if (options.amnesia) {
    const double tile_size_m = options.tile_sizes_m.front();
    const unsigned threads = options.threads.front();
    add(threads, tile_size_m, Memory::forgotten, ", junk in derived data");
    add(threads, tile_size_m, Memory::remade, ", world rebuilt");
    add(threads, tile_size_m, Memory::shuffled, ", bodies moved in memory");
  }
  if (options.reach) {
    Variant& variant = add(1, options.tile_sizes_m.front(), Memory::kept, ", bodies beyond reach hidden");
    if (variant.world().spec().ranging == engine::RangingEngine::grid)
      throw InputError(
          "troupe check: error: --reach needs the exact ray engine, but this run uses the grid engine: give "
          "--raytracer exact");
    variant.world().hide_beyond_reach(true);
  }
  return variants;
}

/// Lets the variants compute the measures that the world lists. Measures in Python are left out
/// (print_foreign_measures()). So are two sorts of variants: those of several ranks, on which computing
/// measures would move the data of all robots to rank 0 in each tick, and those that change data of the world
/// between two ticks. The variants must not be moved in memory after the call.
void add_measures(std::vector<Variant>& variants) {
  const Simulation& first = variants.front().simulation;
  std::vector<std::string> names;
  for (const engine::MeasureSpec& measure : variants.front().world().spec().measures)
    if (const auto kind = first.registry().find_measure(measure.kind); kind && !(*kind)->is_foreign)
      names.push_back(engine::measure_name(measure));
  if (names.empty()) return;
  for (Variant& variant : variants)
    if (variant.memory == Memory::kept && variant.simulation.ranks() == 1)
      variant.measures.emplace(variant.simulation, names);
}

/// Returns the differences between the measures of two variants as lines of text.
std::vector<std::string> measure_differences(Variant& expected, Variant& variant) {
  std::vector<std::string> lines;
  if (!expected.measures || !variant.measures) return lines;
  const std::vector<double> right = expected.measures->values();
  const std::vector<double> found = variant.measures->values();
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  for (std::size_t m = 0; m < right.size(); ++m)
    if (bits(found[m]) != bits(right[m]) && !(std::isnan(found[m]) && std::isnan(right[m])))
      lines.push_back(fmt::format("measure {} is 0x{} ({}), not 0x{} ({})", expected.measures->columns()[m],
                                  hex(bits(found[m])), found[m], hex(bits(right[m])), right[m]));
  return lines;
}

/// Repeats every decision of the controllers of a variant and compares the results (--controllers).
class Decisions {
 public:
  explicit Decisions(Variant& variant) : world_(variant.simulation.world()) {
    const FilledStorage filled(k_fills[1]);
    check_ = std::make_unique<engine::ControllerCheck>(world_, variant.simulation.registry());
  }

  /// Initialises the memory of every controller twice. Returns, as lines of text, the differences and the
  /// fields that no initialisation sets. Call it once, before the first step.
  std::vector<std::string> start_twice() { return texts(check_->start_twice()); }

  /// Repeats the decisions of the last step. Returns the differences as lines of text. Call it after each
  /// step.
  std::vector<std::string> repeat() {
    if (check_->pending() > 0 && check_->decisions() == 0) {
      // Wait once, so that a controller that reads a clock of whole seconds decides differently.
      std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    }
    // The decisions are repeated on a thread that has never run a controller, because thread_local variables
    // of a controller then have their initial values.
    std::future<std::vector<engine::ControllerFinding>> findings;
    try {
      findings = std::async(std::launch::async, [this] { return check_->repeat(); });
    } catch (const std::system_error& error) {
      partition::throw_no_thread(error);
    }
    return texts(findings.get());
  }
  std::uint64_t count() const { return check_->decisions(); }
  bool differ() const { return differ_; }

 private:
  std::vector<std::string> texts(const std::vector<engine::ControllerFinding>& findings) {
    differ_ = differ_ || !findings.empty();
    std::vector<std::string> lines;
    for (const auto& finding : findings) lines.push_back("  " + engine::finding_text(world_, finding));
    return lines;
  }

  engine::World& world_;
  std::unique_ptr<engine::ControllerCheck> check_;
  bool differ_ = false;
};

/// Compares the states and the measures of all variants with those of the first variant. Returns the
/// differences as lines of text, and marks the variants that differ.
std::vector<std::string> compare(std::vector<Variant>& variants) {
  std::vector<std::string> lines;
  engine::World& expected = variants.front().world();
  for (auto variant = variants.begin() + 1; variant != variants.end(); ++variant) {
    std::vector<std::string> differences;
    for (const auto& difference : engine::state_differences(expected, variant->world()))
      differences.push_back(engine::difference_text(expected, difference));
    if (differences.empty()) differences = measure_differences(variants.front(), *variant);
    if (differences.empty()) continue;
    variant->differs = true;
    lines.push_back(fmt::format("  {}, compared with {}:", variant->name, variants.front().name));
    for (const std::string& difference : differences) lines.push_back("    " + difference);
  }
  return lines;
}

/// Compares each variant with the first variant only by how the last step ended: completed, or with an error.
/// Returns the differences as lines of text, and marks the variants that differ. If the steps of all variants
/// ended with an error, the world causes the error: throws the error of the first variant as a StepError.
/// (The texts of the errors may differ: if a sensor, device or drive throws an exception, the text names the
/// first robot of a batch, and the batches depend on the number of threads.)
std::vector<std::string> compare_errors(std::vector<Variant>& variants) {
  const auto outcome = [](const Variant& variant) {
    return variant.error ? fmt::format("stopped with an error: {}", *variant.error)
                         : std::string("completed the tick");
  };
  const Variant& first = variants.front();
  if (std::ranges::all_of(variants, [](const Variant& variant) { return variant.error.has_value(); }))
    throw engine::StepError(*first.error);
  std::vector<std::string> lines;
  for (auto variant = variants.begin() + 1; variant != variants.end(); ++variant) {
    if (variant->error.has_value() == first.error.has_value()) continue;
    variant->differs = true;
    lines.push_back(fmt::format("  {}, compared with {}:", variant->name, first.name));
    lines.push_back("    " + outcome(*variant));
    if (first.error) lines.push_back(fmt::format("    {} {}", first.name, outcome(first)));
  }
  return lines;
}

/// Steps the variants to simulated time `end_s`, s, or to the first tick at which they differ. Returns the
/// differences as lines of text; empty: none. decisions: null unless --controllers is given.
std::vector<std::string> step_to_end(std::vector<Variant>& variants, Decisions* decisions, double end_s) {
  Simulation& first = variants.front().simulation;
  const std::uint64_t ticks = engine::ticks_until(end_s, first.tick_s());
  Progress progress(first.time_s(), end_s, true);
  std::vector<std::string> lines = decisions ? decisions->start_twice() : std::vector<std::string>();
  for (;;) {
    std::vector<std::string> found = compare_errors(variants);
    if (found.empty()) found = compare(variants);  // the states can be compared only if all are complete
    lines.insert(lines.end(), found.begin(), found.end());
    if (!lines.empty() || first.tick() >= ticks) return lines;
    for (Variant& variant : variants) {
      variant.step();
      // The decisions must be repeated before the other variants step, because decisions in these variants
      // would change the static variables of a controller.
      if (decisions && &variant == &variants.front() && !variant.error) lines = decisions->repeat();
    }
    progress.update(first.time_s());
  }
}

void print_table(std::vector<Variant>& variants, const Decisions* decisions) {
  struct TableLine {
    std::string what, ticks, result, hash;
  };
  const auto result_of = [](bool differs) { return differs ? "DIFFERS" : "same bits"; };
  std::vector<TableLine> lines{{"variant", "ticks", "result", "hash"}};
  for (Variant& variant : variants)
    lines.push_back({variant.name, fmt::format("{}", variant.world().tick()), result_of(variant.differs),
                     variant.error ? "-" : hex(variant.world().hashes().state)});
  if (decisions)
    lines.push_back({fmt::format("{} decisions, each made 3 times", decisions->count()),
                     fmt::format("{}", variants.front().simulation.tick()), result_of(decisions->differ()),
                     "-"});
  std::size_t name_width = 0;
  std::size_t tick_width = 0;
  for (const TableLine& line : lines) {
    name_width = std::max(name_width, line.what.size());
    tick_width = std::max(tick_width, line.ticks.size());
  }
  for (const TableLine& line : lines)
    print("{:<{}}  {:>{}}  {:<9}  {}\n", line.what, name_width, line.ticks, tick_width, line.result,
          line.hash);
}

/// Prints a note for each measure of the world that is computed in Python, because the check says nothing
/// about its values.
void print_foreign_measures(const Simulation& simulation) {
  const engine::WorldSpec& world = simulation.world().spec();
  std::vector<std::string> kinds;
  for (const engine::MeasureSpec& measure : world.measures) kinds.push_back(measure.kind);
  for (const engine::StopSpec& condition : world.experiment.stop_when)
    kinds.push_back(condition.measure.kind);
  std::ranges::sort(kinds);
  kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
  for (const std::string& name : kinds)
    if (const auto kind = simulation.registry().find_measure(name); kind && (*kind)->is_foreign)
      print(
          "note: the measure {} is computed in Python: Troupe does not guarantee that its values are equal "
          "in all compared runs\n",
          name);
}

/// Throws InputError if the options ask for a single run, or for distributed robots in a run of one rank.
void require_variants(const CheckOptions& options) {
  if (options.threads.size() * options.tile_sizes_m.size() * options.ranks.size() < 2 &&
      !options.simulation.processes && !options.controllers && !options.amnesia && !options.reach)
    throw InputError(
        "troupe check: error: only one run is requested, so there is nothing to compare: give several "
        "numbers of threads, as in --threads 1,8 (--ranks, --tile-size, --amnesia, --reach and --controllers "
        "also add runs)");
  if (options.simulation.distribute && !options.simulation.processes && std::ranges::max(options.ranks) < 2)
    throw InputError(
        "--distribute: error: no run of this check has several ranks, so no robots would be distributed: "
        "give numbers of ranks, as in --ranks 2,3");
}

/// Prints how the ranks of the variants share the work, and how to repeat it.
void print_ranks(const CheckOptions& options, const std::vector<Variant>& variants) {
  if (std::ranges::max(options.ranks) > 1)
    fmt::print("random delays and order of messages between ranks: --rank-seed {} repeats them\n",
               rank_seed_of(options));
  if (options.simulation.processes)
    fmt::print("random division of the robots among the processes: --rank-seed {} repeats it\n",
               rank_seed_of(options));
  if (options.simulation.distribute)
    if (const auto several = std::ranges::find_if(
            variants, [](const Variant& variant) { return variant.simulation.ranks() > 1; });
        several != variants.end()) {
      const RankStatistics ranks = several->simulation.rank_statistics();
      print("robot data of the ranks: {}\n",
            ranks.is_distributed ? std::string("distributed")
                                 : fmt::format("replicated, because {}", ranks.why_replicated));
    }
}

}  // namespace

ExitCode check(const CheckOptions& options, const engine::Registry& registry) try {
  require_variants(options);
  std::vector<Variant> variants = load(options, registry);
  add_measures(variants);
  Simulation& first = variants.front().simulation;
  print_lines(first.warnings());
  const double end_s = end_of(options, first);
  std::optional<Decisions> decisions;
  if (options.controllers) decisions.emplace(variants.front());
  print_ranks(options, variants);
  const std::vector<std::string> differences =
      step_to_end(variants, decisions ? &*decisions : nullptr, end_s);
  print_table(variants, decisions ? &*decisions : nullptr);
  print_foreign_measures(first);
  if (!differences.empty()) {
    fmt::print("differs at tick {} ({:.10g} s):\n", first.tick(), first.time_s());
    for (const std::string& line : differences) print("{}\n", line);
  }
  return differences.empty() ? k_finished : k_failed;
} catch (const InputError& error) {
  print_line(error.what());
  return k_bad_input;
}

}  // namespace troupe::apps
