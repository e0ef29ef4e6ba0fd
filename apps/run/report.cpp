#include "apps/run/report.hpp"

#include "apps/numbers.hpp"
#include "base/hash.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <numeric>

namespace troupe::apps {
namespace {

/// Returns a / b, or 0 if b is not positive.
double ratio(double a, double b) { return b > 0 ? a / b : 0; }

/// All members of RankCounts.
constexpr std::array k_counts{&RankCounts::ticks,      &RankCounts::own,           &RankCounts::ghosts,
                              &RankCounts::neighbours, &RankCounts::distributions, &RankCounts::migrated,
                              &RankCounts::rounds,     &RankCounts::messages,      &RankCounts::bytes};
static_assert(sizeof(RankCounts) == k_counts.size() * sizeof(std::uint64_t), "a member is missing");

/// Returns the mean and the largest value among the ranks as text: "12.5 bytes (at most 20)". what: "bytes".
std::string per_rank_text(const Report::PerRank& value, std::string_view what) {
  return fmt::format("{} {} (at most {})", four_digits(value.mean), what, four_digits(value.most));
}

std::string percent(double part, double whole) { return fmt::format("{:.1f} %", 100 * ratio(part, whole)); }

/// Appends a line of the summary: a name and a value.
void append_line(std::string_view name, const std::string& value, std::string& text) {
  text += fmt::format("  {:<18} {}\n", name, value);
}

/// Appends the lines of the summary about the ranks.
void append_ranks(const Report& report, std::string& text) {
  const auto line = [&](std::string_view name, const std::string& value) { append_line(name, value, text); };
  if (report.ranks.ranks > 1)
    line("ranks",
         fmt::format("{} on {}, rank 0 waited {} s, sent {} bytes in {} messages per tick, "
                     "rebalanced {}",
                     report.ranks.ranks, counted(report.ranks.nodes, "node"),
                     four_digits(report.ranks.waited_s), four_digits(report.bytes_per_tick()),
                     four_digits(report.messages_per_tick()), counted(report.ranks.rebalanced, "time")));
  if (!report.rank_counts.empty())
    line("per rank", fmt::format("{}, {}, in each tick",
                                 per_rank_text(report.per_rank(&RankCounts::messages), "messages"),
                                 per_rank_text(report.per_rank(&RankCounts::bytes), "bytes")));
  if (report.ranks.is_distributed) {
    const Report::PerRank own = report.per_rank(&RankCounts::own);
    line("robots per rank",
         fmt::format("{}, {}, imbalance {:.2f}", per_rank_text(own, "own"),
                     per_rank_text(report.per_rank(&RankCounts::ghosts), "ghosts"), own.imbalance()));
    line("neighbours",
         fmt::format("{}, {}, per rank and tick",
                     per_rank_text(report.per_rank(&RankCounts::neighbours), "neighbouring ranks"),
                     per_rank_text(report.per_rank(&RankCounts::rounds), "rounds of messages")));
    line("robot data",
         fmt::format("distributed: {} ghosts (copies of robots of other ranks) per own robot; robots divided "
                     "among the ranks {}",
                     four_digits(report.ghosts_per_own()), counted(report.ranks.distributions, "time")));
  } else if (!report.ranks.why_replicated.empty())
    line("robot data", fmt::format("replicated on each rank, because {}", report.ranks.why_replicated));
}

/// Adds the values of the summary about the ranks.
void add_ranks(const Report& report, nlohmann::ordered_json& json) {
  json["ranks"] = report.ranks.ranks;
  json["nodes"] = report.ranks.nodes;
  json["rank_waited_s"] = report.ranks.waited_s;
  json["rank_bytes_per_tick"] = report.bytes_per_tick();
  json["rank_messages_per_tick"] = report.messages_per_tick();
  json["rank_rebalanced"] = report.ranks.rebalanced;
  json["rank_form"] = report.ranks.is_distributed ? "distributed" : "replicated";
  if (report.ranks.is_distributed) {
    json["rank_ghosts_per_row"] = report.ghosts_per_own();
    json["rank_distributions"] = report.ranks.distributions;
  }
  // Counts per tick: their mean and their largest value among the ranks.
  const auto put = [&](std::string_view name, std::uint64_t RankCounts::*count) {
    const Report::PerRank value = report.per_rank(count);
    json[fmt::format("ranks_{}_mean", name)] = value.mean;
    json[fmt::format("ranks_{}_most", name)] = value.most;
  };
  put("own", &RankCounts::own);
  if (report.ranks.is_distributed) {
    put("ghosts", &RankCounts::ghosts);
    put("neighbours", &RankCounts::neighbours);
    put("rounds", &RankCounts::rounds);
    put("migrated", &RankCounts::migrated);
  }
  put("messages", &RankCounts::messages);
  put("bytes", &RankCounts::bytes);
  json["ranks_imbalance"] = report.per_rank(&RankCounts::own).imbalance();
  if (!report.ranks.why_replicated.empty()) json["why_replicated"] = report.ranks.why_replicated;
}

}  // namespace

double Report::times_real_time() const { return ratio(static_cast<double>(ticks_here()) * tick_s, wall_s); }

double Report::ns_per_robot_tick() const {
  return ratio(1e9 * (wall_s - waited_s),
               static_cast<double>(statistics.robots) * static_cast<double>(ticks_here()));
}

double Report::beams_per_tick() const {
  return ratio(static_cast<double>(statistics.beams), static_cast<double>(statistics.ticks));
}

double Report::bytes_per_tick() const {
  return ratio(static_cast<double>(ranks.bytes), static_cast<double>(ticks_here()));
}

double Report::messages_per_tick() const {
  return ratio(static_cast<double>(ranks.messages), static_cast<double>(ticks_here()));
}

void Report::subtract_counts(std::span<const RankCounts> before) {
  for (std::size_t rank = 0; rank < rank_counts.size(); ++rank)
    for (const auto count : k_counts) rank_counts[rank].*count -= before[rank].*count;
}

double Report::ghosts_per_own() const {
  return ratio(per_rank(&RankCounts::ghosts).mean, per_rank(&RankCounts::own).mean);
}

double Report::PerRank::imbalance() const { return ratio(most, mean); }

Report::PerRank Report::per_rank(std::uint64_t RankCounts::*count) const {
  PerRank result;
  for (const RankCounts& counts : rank_counts) {
    const double per_tick = ratio(static_cast<double>(counts.*count), static_cast<double>(counts.ticks));
    result.mean += per_tick / static_cast<double>(rank_counts.size());
    result.most = std::max(result.most, per_tick);
  }
  return result;
}

double Report::observe_s() const {
  return std::max(0.0, wall_s - waited_s - std::accumulate(phase_s.begin(), phase_s.end(), 0.0));
}

std::string summary_text(const Report& report) {
  const Statistics& s = report.statistics;
  std::string text;
  const auto line = [&](std::string_view name, const std::string& value) { append_line(name, value, text); };

  if (report.stopped)
    text += fmt::format("stopped early at {:.10g} of {:.10g} s\n", s.time_s, report.end_s);
  else if (!report.stopped_by.empty())
    text += fmt::format("finished at {:.10g} of {:.10g} s: {}\n", s.time_s, report.end_s, report.stopped_by);
  else
    text += "finished\n";
  line("robots", grouped(s.robots));
  line("ticks", fmt::format("{} of {:.10g} s", grouped(s.ticks), report.tick_s));
  line("simulated", fmt::format("{:.10g} s", s.time_s));
  line("wall",
       fmt::format("{} s, after {} s of loading", four_digits(report.wall_s), four_digits(report.load_s)));
  line("times real time", four_digits(report.times_real_time()));
  if (report.rate > 0)
    line("waited",
         fmt::format("{} s, to keep {:.10g} x real time", four_digits(report.waited_s), report.rate));
  if (s.robots > 0)
    line("cost", fmt::format("{} ns per robot and tick", four_digits(report.ns_per_robot_tick())));
  line("beams", fmt::format("{} per tick", four_digits(report.beams_per_tick())));
  std::string shares;
  for (std::size_t i = 0; i < k_phases; ++i)
    shares +=
        fmt::format("{} {}, ", phase_name(static_cast<Phase>(i)), percent(report.phase_s[i], report.wall_s));
  line("phases", shares + "observe " + percent(report.observe_s(), report.wall_s));
  line("threads", fmt::format("{}, serial share {:.1f} %, imbalance {:.2f}", report.threads,
                              100 * report.serial_share, report.imbalance));
  append_ranks(report, text);
  line("peak memory",
       fmt::format("{} MiB", four_digits(static_cast<double>(report.peak_rss_bytes) / (1024.0 * 1024.0))));
  line("stalled", fmt::format("{} ({})", grouped(s.stalled),
                              percent(static_cast<double>(s.stalled), static_cast<double>(s.robots))));
  if (s.held_at_bounds > 0) line("held at bounds", grouped(s.held_at_bounds));
  line("mean displacement", fmt::format("{} m", four_digits(s.mean_displacement_m)));
  if (!report.checkpoint.empty()) line("checkpoint", report.checkpoint);
  line("state hash", hex(report.hashes.state));
  return text;
}

std::string summary_json(const Report& report) {
  const Statistics& s = report.statistics;
  nlohmann::ordered_json json;
  json["world"] = report.world;
  json["title"] = report.title;
  json["robots"] = s.robots;
  json["ticks"] = s.ticks;
  json["tick_s"] = report.tick_s;
  json["sim_s"] = s.time_s;
  json["end_s"] = report.end_s;
  json["stopped_early"] = report.stopped;
  if (!report.stopped_by.empty()) json["stopped_by"] = report.stopped_by;
  json["wall_s"] = report.wall_s;
  json["load_s"] = report.load_s;
  json["times_real_time"] = report.times_real_time();
  if (report.rate > 0) {
    json["rate"] = report.rate;
    json["waited_s"] = report.waited_s;
  }
  json["ns_per_robot_tick"] = report.ns_per_robot_tick();
  json["beams"] = s.beams;
  json["beams_per_tick"] = report.beams_per_tick();
  for (std::size_t i = 0; i < k_phases; ++i)
    json[fmt::format("share_{}", phase_name(static_cast<Phase>(i)))] =
        ratio(report.phase_s[i], report.wall_s);
  json["share_observe"] = ratio(report.observe_s(), report.wall_s);
  json["threads"] = report.threads;
  if (report.ranks.ranks > 1) add_ranks(report, json);
  json["serial_share"] = report.serial_share;
  json["imbalance"] = report.imbalance;
  json["peak_rss_bytes"] = report.peak_rss_bytes;
  json["stalled"] = s.stalled;
  json["held_at_bounds"] = s.held_at_bounds;
  json["conflict_rounds"] = s.conflict_rounds;
  json["mean_displacement_m"] = s.mean_displacement_m;
  if (!report.checkpoint.empty()) json["checkpoint"] = report.checkpoint;
  json["state_hash"] = hex(report.hashes.state);
  json["pose_hash"] = hex(report.hashes.pose);
  json["velocity_hash"] = hex(report.hashes.velocity);
  json["sensor_hash"] = hex(report.hashes.sensor);
  json["memory_hash"] = hex(report.hashes.memory);
  // Option values that are numbers or truth values keep this type in JSON: a seed is a number, not a string.
  for (const auto& [key, value] : report.options) {
    if (json.contains(key)) continue;
    const auto parsed = nlohmann::ordered_json::parse(value, nullptr, false);
    if (parsed.is_number() || parsed.is_boolean())
      json[key] = parsed;
    else
      json[key] = value;
  }
  json["version"] = version_line();
  // File names need not be UTF-8; replacing invalid bytes keeps dump() from throwing.
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace troupe::apps
