#include "apps/run/dry_run.hpp"

#include "apps/memory.hpp"
#include "apps/numbers.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace troupe::apps {
namespace {

/// Returns the highest speed that the drives of a world allow, m/s. A drive whose kind does not tell it
/// (DriveKind::top_speed) counts as 0.
double highest_speed(const engine::World& world) {
  double highest = 0;
  for (std::size_t t = 0; t < world.view().types().size(); ++t)
    if (const auto& drive = world.view().types()[t].drive; drive && drive->kind->top_speed)
      highest = std::max(highest, drive->kind->top_speed(world.spec().types[t].drive->params));
  return highest;
}

double mib(double bytes) { return bytes / (1024.0 * 1024.0); }

}  // namespace

Report::PerRank DryRun::rank_state_bytes() const {
  if (!is_distributed) return {static_cast<double>(state_bytes), static_cast<double>(state_bytes)};
  const double per_row = rows > 0 ? static_cast<double>(state_bytes) / static_cast<double>(rows) : 0;
  return {per_row * (own.mean + ghosts.mean), per_row * most_rows};
}

DryRun dry_run_of(const Simulation& simulation, const Report& report, unsigned ranks, bool distribute) {
  const engine::World& world = simulation.world();
  const Statistics statistics = simulation.statistics();
  DryRun run{.world = report.world,
             .robots = statistics.robots,
             .rows = world.view().rows(),
             .ticks = engine::ticks_until(report.end_s, report.tick_s) - report.first_tick,
             .end_s = report.end_s,
             .world_bytes = resident_bytes(),
             .state_bytes = statistics.state_bytes,
             .ranks = ranks};
  const double share = static_cast<double>(run.rows) / ranks;
  run.own = {share, std::ceil(share)};
  if (!distribute || ranks == 1) return run;
  run.why_replicated = engine::why_replicated(world);
  run.is_distributed = run.why_replicated.empty();
  if (!run.is_distributed) return run;
  run.longest_motion_m = highest_speed(world) * world.view().tick_s();
  const engine::HaloPlan plan = engine::plan_halo(world, ranks, run.longest_motion_m);
  run.coverage_m = plan.coverage_m;
  const auto per_rank = [&](std::size_t engine::HaloPlan::Rank::*count) {
    Report::PerRank result;
    for (const engine::HaloPlan::Rank& rank : plan.ranks) {
      result.mean += static_cast<double>(rank.*count) / ranks;
      result.most = std::max(result.most, static_cast<double>(rank.*count));
    }
    return result;
  };
  run.own = per_rank(&engine::HaloPlan::Rank::own);
  run.ghosts = per_rank(&engine::HaloPlan::Rank::ghosts);
  run.neighbours = per_rank(&engine::HaloPlan::Rank::neighbours);
  for (const engine::HaloPlan::Rank& rank : plan.ranks)
    run.most_rows = std::max(run.most_rows, static_cast<double>(rank.own + rank.ghosts));
  return run;
}

std::string dry_run_text(const DryRun& run) {
  std::string text = "dry run: nothing is computed or written\n";
  const auto line = [&](std::string_view name, const std::string& value) {
    text += fmt::format("  {:<18} {}\n", name, value);
  };
  const auto of_rank = [](const Report::PerRank& value) {
    return fmt::format("{} (at most {})", four_digits(value.mean), four_digits(value.most));
  };
  line("robots", grouped(run.robots));
  line("ticks", fmt::format("{}, until {:.10g} s", grouped(run.ticks), run.end_s));
  line("memory", fmt::format("{} MiB with the whole world, of which {} MiB are state tables",
                             four_digits(mib(static_cast<double>(run.world_bytes))),
                             four_digits(mib(static_cast<double>(run.state_bytes)))));
  if (run.ranks == 1) return text;
  line("ranks", grouped(run.ranks));
  line("robots per rank", of_rank(run.own));
  if (!run.is_distributed) {
    line("robot data", "replicated: each rank has all robots" +
                           (run.why_replicated.empty() ? "" : ", because " + run.why_replicated));
    return text;
  }
  line("ghosts", fmt::format("{} per rank: copies of robots of other ranks, up to {} m from the region of "
                             "the rank",
                             of_rank(run.ghosts), four_digits(run.coverage_m)));
  line("neighbours", fmt::format("{} per rank: ranks that own its ghosts or have ghosts of its robots",
                                 of_rank(run.neighbours)));
  const Report::PerRank bytes = run.rank_state_bytes();
  line("state per rank", fmt::format("{} MiB in the state tables, for own robots and ghosts",
                                     of_rank({mib(bytes.mean), mib(bytes.most)})));
  line("robot data",
       "distributed: each rank loads the whole world, and then has only its own robots and ghosts");
  return text;
}

std::string dry_run_json(const DryRun& run) {
  nlohmann::ordered_json json;
  json["world"] = run.world;
  json["dry_run"] = true;
  json["robots"] = run.robots;
  json["ticks"] = run.ticks;
  json["end_s"] = run.end_s;
  json["world_bytes"] = run.world_bytes;
  json["state_bytes"] = run.state_bytes;
  json["ranks"] = run.ranks;
  if (run.ranks > 1) {
    const auto put = [&](std::string_view name, const Report::PerRank& value) {
      json[fmt::format("ranks_{}_mean", name)] = value.mean;
      json[fmt::format("ranks_{}_most", name)] = value.most;
    };
    json["rank_form"] = run.is_distributed ? "distributed" : "replicated";
    if (!run.why_replicated.empty()) json["why_replicated"] = run.why_replicated;
    put("own", run.own);
    put("state_bytes", run.rank_state_bytes());
    if (run.is_distributed) {
      put("ghosts", run.ghosts);
      put("neighbours", run.neighbours);
      json["coverage_m"] = run.coverage_m;
      json["longest_motion_m"] = run.longest_motion_m;
    }
  }
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace troupe::apps
