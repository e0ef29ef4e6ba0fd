#include "perf/paper_report.hpp"

#include "base/hash.hpp"
#include "partition/processors.hpp"
#include "partition/simd_target.hpp"
#include "troupe/simulation.hpp"
#include "perf/paper_aims.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

namespace troupe::perf {
namespace {

constexpr std::string_view k_begin = "<!-- perf_paper: begin -->";
constexpr std::string_view k_end = "<!-- perf_paper: end -->";
constexpr double k_mb = 1e6;

/// The value rounded to an integer, with commas between groups of three digits, as in "12,345,678".
std::string grouped(double value) {
  std::string text = fmt::format("{:.0f}", std::abs(value));
  for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3)
    text.insert(static_cast<std::size_t>(at), 1, ',');
  return (value < 0 ? "-" : "") + text;
}

/// The value with three significant digits. Values from 100 on are rounded to an integer, and values below
/// 0.1 to four decimals. There is never an exponent.
std::string three_digits(double value) {
  if (value >= 100) return grouped(value);
  if (value >= 10) return fmt::format("{:.1f}", value);
  return fmt::format("{:.{}f}", value, value >= 1 ? 2 : value >= 0.1 ? 3 : 4);
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

std::vector<double> speeds(const Timing& timing) {
  std::vector<double> out;
  for (const double s : timing.wall_s) out.push_back(timing.times_real_time(s));
  return out;
}

std::vector<double> costs(const Timing& timing) {
  std::vector<double> out;
  for (const double s : timing.wall_s) out.push_back(timing.ns(s));
  return out;
}

std::string found(const Reference& reference, const std::string& column, const Timing& timing) {
  const auto scenes = reference.find(column);
  if (scenes == reference.end()) return "";
  const auto value = scenes->second.find({timing.run.scene.name, timing.run.frames});
  return value == scenes->second.end() ? "" : three_digits(value->second);
}

Sheet timing_sheet(const Report& report, const Table& table, const Reference& reference) {
  const bool clusters = table.id == "clusters";
  const bool watching = table.id == "watching";
  Sheet sheet{table.title, table.note, {}, {}};
  double for_s = 0;
  for (const CaseTiming& one : report.cases) {
    if (one.table != table.id) continue;
    for (const Timing& timing : one.timings) {
      for_s = static_cast<double>(timing.ticks) * timing.tick_s;
      const std::vector<double> x = speeds(timing);
      const double ns = median(costs(timing));
      std::vector<std::string> row{
          timing.run.scene.name.substr(0, timing.run.scene.name.rfind('/')),
          grouped(static_cast<double>(timing.robots)),
          grouped(timing.beams_per_tick),
          fmt::format("{}", timing.run.threads),
          timing.run.frames ? fmt::format("{}", timing.frames) : "-",
          grouped(ns),
          three_digits(median(x)),
          three_digits(minimum(x)),
          three_digits(maximum(x)),
      };
      if (clusters) {
        // The dispersed run with the same number of threads comes before the clustered one.
        const auto base = std::ranges::find_if(one.timings, [&](const Timing& other) {
          return other.run.threads == timing.run.threads && !other.run.frames;
        });
        row.push_back(fmt::format("{:.2f}", ns / median(costs(*base))));
        row.push_back(fmt::format("{:.1f}", timing.rounds_per_tick));
        row.push_back(percent(timing.move_share));
        row.push_back(percent(timing.stalled_share));
      } else if (watching) {
        const auto cost = watching_cost(one, timing);
        row.emplace_back(watch_name(timing.run.watch));
        row.push_back(cost ? fmt::format("{:.1f} %", 100 * *cost) : "");
      } else {
        row.push_back(found(reference, "paper", timing));
        row.push_back(found(reference, "Stage 4.3", timing));
      }
      row.push_back(hex(timing.hash));
      sheet.rows.push_back(std::move(row));
    }
  }
  sheet.title += fmt::format(", {:.4g} s", for_s);
  sheet.header = {"world",       "robots", "beams per tick",
                  "threads",     "frames", "ns per robot and tick",
                  "x real time", "min",    "max"};
  if (clusters)
    sheet.header.insert(sheet.header.end(), {"to dispersed", "rounds per tick", "move", "stalled"});
  else if (watching)
    sheet.header.insert(sheet.header.end(), {"observer", "cost"});
  else
    sheet.header.insert(sheet.header.end(), {"paper", "Stage 4.3"});
  sheet.header.emplace_back("state hash");
  return sheet;
}

/// The entry with this name in the description of the machine; empty if there is none.
std::string of_machine(const Report& report, std::string_view name) {
  for (const auto& [key, value] : report.machine)
    if (key == name) return value;
  return {};
}

/// The table with one column per instruction set.
Sheet simd_sheet(const Report& report, const Table& table) {
  Sheet sheet{table.title, table.note, {"world", "robots", "beams per tick"}, {}};
  if (const std::string processor = of_machine(report, "processor"); !processor.empty())
    sheet.title += ": " + processor;
  for (const CaseTiming& one : report.cases) {
    if (one.table != table.id) continue;
    const Timing& first = one.timings.front();
    if (sheet.rows.empty()) {
      for (const Timing& timing : one.timings) sheet.header.push_back(timing.run.simd);
      for (std::size_t i = 1; i < one.timings.size(); ++i)
        sheet.header.push_back(fmt::format("{} / {}", one.timings[i].run.simd, first.run.simd));
      sheet.header.emplace_back("state hash");
    }
    std::vector<std::string> row{first.run.scene.name.substr(0, first.run.scene.name.rfind('/')),
                                 grouped(static_cast<double>(first.robots)), grouped(first.beams_per_tick)};
    for (const Timing& timing : one.timings) row.push_back(grouped(median(costs(timing))));
    for (std::size_t i = 1; i < one.timings.size(); ++i)
      row.push_back(fmt::format("{:.2f}", median(costs(one.timings[i])) / median(costs(first))));
    row.push_back(hex(first.hash));
    sheet.rows.push_back(std::move(row));
  }
  return sheet;
}

Sheet scaling_sheet(const Report& report) {
  Sheet sheet{
      "Threads",
      "`probe`: the speed-up that this number of threads reaches in a calculation in which they share no "
      "data, measured between the repetitions. No program can be expected to reach more on the machine.",
      {"world", "robots", "threads", "speed-up", "probe", "speed-up / probe"},
      {}};
  for (const Scaling& s : scalings(report)) {
    sheet.rows.push_back({s.timing->run.scene.name.substr(0, s.timing->run.scene.name.rfind('/')),
                          grouped(static_cast<double>(s.timing->robots)),
                          fmt::format("{}", s.timing->run.threads), fmt::format("{:.2f}", s.speedup),
                          fmt::format("{:.2f}", s.probe), percent(s.speedup / s.probe)});
  }
  return sheet;
}

template <class Member>
double median_of(const ChildTiming& timing, Member member) {
  std::vector<double> values;
  for (const ChildReport& report : timing.reports) values.push_back(member(report));
  return median(values);
}

std::string child_name(const ChildTiming& timing) {
  const std::string& name = timing.child.scene.name;
  return name.substr(0, name.rfind('/')) + (timing.child.as_text ? ".world text" : ".json");
}

Sheet loading_sheet(const Report& report) {
  Sheet sheet{"Loading and memory",
              "Each world is loaded in a process of its own, with one thread per core. Memory is resident "
              "memory after the first ticks; bytes per robot are the additional memory relative to the empty "
              "world, divided by the number of robots.",
              {"world", "robots", "load s", "min", "max", "reading s", "resident MB", "peak MB",
               "bytes per robot", "state hash"},
              {}};
  double empty = 0;
  for (const ChildTiming& timing : report.children) {
    const double rss = median_of(timing, [](const ChildReport& r) { return r.rss_bytes; });
    const std::size_t robots = timing.reports.front().robots;
    if (timing.child.empty) empty = rss;
    std::vector<double> loads;
    for (const ChildReport& r : timing.reports) loads.push_back(r.read_s + r.build_s);
    // Only worlds with the walls of the empty hospital are comparable with it; the campus has other walls.
    const bool comparable = empty > 0 && robots > 0 && timing.child.scene.name.starts_with("hospital-10cm");
    sheet.rows.push_back(
        {child_name(timing), grouped(static_cast<double>(robots)), fmt::format("{:.3f}", median(loads)),
         fmt::format("{:.3f}", minimum(loads)), fmt::format("{:.3f}", maximum(loads)),
         fmt::format("{:.3f}", median_of(timing, [](const ChildReport& r) { return r.read_s; })),
         fmt::format("{:.1f}", rss / k_mb),
         fmt::format("{:.1f}", median_of(timing, [](const ChildReport& r) { return r.peak_bytes; }) / k_mb),
         comparable ? grouped((rss - empty) / static_cast<double>(robots)) : "",
         hex(timing.reports.front().hash)});
  }
  return sheet;
}

nlohmann::ordered_json spread(const std::vector<double>& values) {
  return {{"min", minimum(values)}, {"median", median(values)}, {"max", maximum(values)}};
}

}  // namespace

std::vector<std::pair<std::string, std::string>> describe_machine() {
  std::vector<std::pair<std::string, std::string>> out;
  std::ifstream cpuinfo("/proc/cpuinfo");
  std::string model;
  for (std::string line; model.empty() && std::getline(cpuinfo, line);)
    if (line.starts_with("model name")) model = line.substr(std::min(line.size(), line.find(':') + 2));
  if (!model.empty()) out.emplace_back("processor", model);
  std::string usable;
  for (const std::string& name : partition::simd_targets().usable)
    usable += (usable.empty() ? "" : " ") + name;
  out.emplace_back("instruction sets", usable);
  out.emplace_back("kernels run on", partition::simd_target());
  out.emplace_back("cores", fmt::format("{}", partition::processors_allowed()));
  std::ifstream meminfo("/proc/meminfo");
  std::string name;
  if (double kib = 0; meminfo >> name >> kib)
    out.emplace_back("memory", fmt::format("{:.1f} GB", kib * 1024 / 1e9));
  std::ifstream loadavg("/proc/loadavg");
  if (std::string load; loadavg >> load) out.emplace_back("load before the run", load);
  out.emplace_back("program", version_line());
  return out;
}

Reference read_reference(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: error: cannot be read", file.string()));
  Reference reference;
  const nlohmann::json known = nlohmann::json::parse(stream);
  for (const auto& series : known.at("series"))
    for (const auto& point : series.at("points"))
      if (point.contains("scene"))
        reference[series.at("column")][{point.at("scene"), false}] = point.at("times_real_time");
  for (const auto& row : known.at("paper").at("rows"))
    for (std::size_t i = 0; i < row.at("robots").size(); ++i)
      reference["paper"][{
          fmt::format("{}/{}", row.at("world").get<std::string>(), row.at("robots").at(i).get<std::size_t>()),
          row.at("frames")}] = row.at("simulated_s").get<double>() / row.at("run_time_s").at(i).get<double>();
  return reference;
}

std::vector<Scaling> scalings(const Report& report) {
  std::vector<Scaling> out;
  for (const CaseTiming& one : report.cases) {
    if (one.table == "clusters" || one.table == "watching" || one.table == "grid" || one.table == "simd")
      continue;
    const Timing& single = one.timings.front();
    if (single.run.threads != 1) continue;
    for (const Timing& timing : one.timings) {
      if (timing.run.frames || timing.run.threads == 1) continue;
      const double probe =
          timing.run.threads * median(one.probe_s.at(1)) / median(one.probe_s.at(timing.run.threads));
      out.push_back({&timing, median(single.wall_s) / median(timing.wall_s), probe});
    }
  }
  return out;
}

std::vector<Sheet> sheets(const Report& report, const Reference& reference) {
  std::vector<Sheet> out;
  if (!report.quick) out.push_back(aims_sheet(report));
  for (const Table& table : report.tables)
    out.push_back(table.id == "simd" ? simd_sheet(report, table) : timing_sheet(report, table, reference));
  out.push_back(scaling_sheet(report));
  out.push_back(loading_sheet(report));
  std::erase_if(out, [](const Sheet& sheet) { return sheet.rows.empty(); });
  return out;
}

std::string plain_text(const Sheet& sheet) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < sheet.header.size(); ++c) {
    std::size_t width = sheet.header[c].size();
    for (const auto& row : sheet.rows) width = std::max(width, row[c].size());
    widths.push_back(width);
  }
  std::string text = fmt::format("\n{}\n{}{}", sheet.title, sheet.note, sheet.note.empty() ? "" : "\n");
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t c = 0; c < cells.size(); ++c)
      text +=
          c == 0 ? fmt::format("{:<{}}", cells[c], widths[c]) : fmt::format("  {:>{}}", cells[c], widths[c]);
    text += '\n';
  };
  line(sheet.header);
  for (const auto& row : sheet.rows) line(row);
  return text;
}

std::string markdown(const Report& report, const std::vector<Sheet>& sheets) {
  std::string text = "\n| machine | |\n|---|---|\n";
  for (const auto& [key, value] : report.machine) text += fmt::format("| {} | {} |\n", key, value);
  text += fmt::format("| repetitions | {} |\n", report.repeat);
  if (report.quick)
    text +=
        "\nThis is a quick run for tests, with fewer robots and shorter times than in the paper. Do not use "
        "its speeds.\n";
  for (const Sheet& sheet : sheets) {
    text += fmt::format("\n### {}\n\n{}{}", sheet.title, sheet.note, sheet.note.empty() ? "" : "\n\n");
    const auto line = [&](const std::vector<std::string>& cells) {
      for (const std::string& cell : cells) text += fmt::format("| {} ", cell);
      text += "|\n";
    };
    line(sheet.header);
    for (std::size_t c = 0; c < sheet.header.size(); ++c) text += c == 0 ? "|---" : "|--:";
    text += "|\n";
    for (const auto& row : sheet.rows) line(row);
  }
  for (const std::string& skipped : report.skipped) text += fmt::format("\nSkipped: {}.\n", skipped);
  return text + '\n';
}

std::string json(const Report& report) {
  nlohmann::ordered_json out;
  for (const auto& [key, value] : report.machine) out["machine"][key] = value;
  out["repeat"] = report.repeat;
  out["quick"] = report.quick;
  out["rows"] = nlohmann::ordered_json::array();
  for (const CaseTiming& one : report.cases) {
    for (const Timing& timing : one.timings) {
      nlohmann::ordered_json row;
      row["table"] = one.table;
      row["scene"] = timing.run.scene.name;
      row["robots"] = timing.robots;
      row["threads"] = timing.run.threads;
      row["frames"] = timing.run.frames;
      row["frames_drawn"] = timing.frames;
      row["with"] = watch_name(timing.run.watch);
      row["simd"] = timing.run.simd.empty() ? of_machine(report, "kernels run on") : timing.run.simd;
      row["ticks"] = timing.ticks;
      row["tick_s"] = timing.tick_s;
      row["beams_per_tick"] = timing.beams_per_tick;
      row["wall_s"] = timing.wall_s;
      row["ns_per_robot_tick"] = spread(costs(timing));
      row["times_real_time"] = spread(speeds(timing));
      row["conflict_rounds_per_tick"] = timing.rounds_per_tick;
      row["share_move"] = timing.move_share;
      row["stalled_share"] = timing.stalled_share;
      row["hash_tick"] = timing.hash_tick;
      row["state_hash"] = hex(timing.hash);
      out["rows"].push_back(std::move(row));
    }
  }
  out["scaling"] = nlohmann::ordered_json::array();
  for (const Scaling& s : scalings(report))
    out["scaling"].push_back({{"scene", s.timing->run.scene.name},
                              {"robots", s.timing->robots},
                              {"threads", s.timing->run.threads},
                              {"speedup", s.speedup},
                              {"probe", s.probe}});
  out["loading"] = nlohmann::ordered_json::array();
  for (const ChildTiming& timing : report.children) {
    for (const ChildReport& r : timing.reports)
      out["loading"].push_back({{"world", child_name(timing)},
                                {"robots", r.robots},
                                {"read_s", r.read_s},
                                {"build_s", r.build_s},
                                {"rss_bytes", r.rss_bytes},
                                {"peak_bytes", r.peak_bytes},
                                {"state_hash", hex(r.hash)}});
  }
  out["skipped"] = report.skipped;
  return out.dump(1) + "\n";
}

void write_between_marks(const std::filesystem::path& file, const std::string& text) {
  std::ostringstream old;
  if (std::ifstream stream(file); stream) old << stream.rdbuf();
  std::string content = old.str();
  const std::size_t begin = content.find(k_begin);
  const std::size_t end = content.find(k_end);
  if (begin != content.npos && end != content.npos && begin < end)
    content.replace(begin + k_begin.size(), end - begin - k_begin.size(), "\n" + text);
  else
    content = text;
  std::ofstream stream(file);
  stream << content << std::flush;
  if (!stream) throw std::runtime_error(fmt::format("{}: error: cannot be written", file.string()));
}

std::vector<std::string> check_hashes(const Report& report, HashBook& book, bool record) {
  std::vector<std::string> faults;
  std::set<std::string> seen;  // recorded scenes and ticks; other rows with the same must have the same hash
  const auto check = [&](const std::string& scene, std::uint64_t tick, std::uint64_t hash,
                         const std::string& run) {
    const auto expected = book.find(scene, tick);
    if (record && seen.insert(fmt::format("{} {}", scene, tick)).second) {
      book.record(scene, tick, hash);
      return;
    }
    if (!expected)
      faults.push_back(
          fmt::format("{} at tick {}: {} has no hash of this scene and tick; --write-hashes records {}",
                      scene, tick, book.file().filename().string(), hex(hash)));
    else if (*expected != hash)
      faults.push_back(fmt::format("{} at tick {}{}: WRONG HASH {}, expected {}", scene, tick, run, hex(hash),
                                   hex(*expected)));
  };
  for (const CaseTiming& one : report.cases) {
    for (const Timing& timing : one.timings) {
      const std::string run = fmt::format(" ({} thread{}{})", timing.run.threads,
                                          timing.run.threads == 1 ? "" : "s", with_text(timing.run));
      check(timing.run.scene.name, timing.hash_tick, timing.hash, run);
      if (!timing.repeatable)
        faults.push_back(
            fmt::format("{}{}: repetitions ended with different hashes", timing.run.scene.name, run));
    }
  }
  for (const ChildTiming& timing : report.children)
    for (const ChildReport& r : timing.reports)
      check((timing.child.as_text ? "text-" : "") + timing.child.scene.name, r.tick, r.hash,
            " (a child process)");
  return faults;
}

}  // namespace troupe::perf
