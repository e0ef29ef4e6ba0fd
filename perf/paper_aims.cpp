#include "perf/paper_aims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

namespace troupe::perf {
namespace {

/// Collects the rows of the table that compares measurements with performance goals. A goal without a
/// measured value gets no row.
class Aims {
 public:
  explicit Aims(const Report& report) : report_(report) {}

  void at_most(const std::string& what, double limit, const char* unit, std::optional<double> value) {
    add(what, fmt::format("at most {:.4g} {}", limit, unit), unit, value, value && *value <= limit);
  }
  void at_least(const std::string& what, double limit, const char* unit, std::optional<double> value) {
    add(what, fmt::format("at least {:.4g} {}", limit, unit), unit, value, value && *value >= limit);
  }

  /// The largest `value` over the rows of a scene that were measured without pictures, without an observer
  /// and on the default instruction set; empty if there are none.
  std::optional<double> most(
      const std::string& scene,
      const std::function<std::optional<double>(const CaseTiming&, const Timing&)>& value) const {
    std::optional<double> found;
    for (const CaseTiming& one : report_.cases)
      for (const Timing& timing : one.timings)
        if (timing.run.scene.name == scene && !timing.run.frames && timing.run.watch == Watch::nothing &&
            timing.run.simd.empty())
          if (const auto v = value(one, timing)) found = std::max(found.value_or(*v), *v);
    return found;
  }
  std::optional<double> ns(const std::string& scene) const {
    return most(scene, [](const CaseTiming&, const Timing& t) {
      return t.run.threads == 1 ? std::optional(t.ns(median(t.wall_s))) : std::nullopt;
    });
  }
  std::optional<double> times_real_time(const std::string& scene, unsigned threads) const {
    return most(scene, [threads](const CaseTiming&, const Timing& t) {
      return t.run.threads == threads ? std::optional(t.times_real_time(median(t.wall_s))) : std::nullopt;
    });
  }
  const Report& report() const { return report_; }
  Sheet sheet() && { return std::move(sheet_); }

 private:
  void add(const std::string& what, const std::string& reach, const char* unit, std::optional<double> value,
           bool met) {
    if (value)
      sheet_.rows.push_back({what, reach, fmt::format("{:.4g} {}", *value, unit), met ? "yes" : "NO"});
  }

  const Report& report_;
  Sheet sheet_{"Aims",
               "Each value in the column `measured` is the median of one row of the tables below.",
               {"what", "aim", "measured", "met"},
               {}};
};

const ChildTiming* child(const Report& report, const std::string& scene, bool as_text) {
  const auto found = std::ranges::find_if(report.children, [&](const ChildTiming& timing) {
    return timing.child.scene.name == scene && timing.child.as_text == as_text;
  });
  return found == report.children.end() ? nullptr : &*found;
}

template <class Member>
std::optional<double> of_child(const ChildTiming* timing, Member member) {
  if (!timing) return std::nullopt;
  std::vector<double> values;
  for (const ChildReport& report : timing->reports) values.push_back(member(report));
  return median(values);
}

void add_costs(Aims& aims) {
  for (const char* scene : {"hospital-10cm/1000", "hospital-10cm/2000", "hospital-10cm/10000",
                            "hospital-10cm/100000", "stage/1000"})
    aims.at_most(fmt::format("{}, one thread", scene), 800, "ns per robot and tick", aims.ns(scene));
  aims.at_most("hospital/1, any number of threads", 10, "us per tick",
               aims.most("hospital/1", [](const auto&, const Timing& t) {
                 return std::optional(t.ns(median(t.wall_s)) / 1e3);
               }));
  for (const char* scene : {"cave-simple/100", "cave-complex/100"})
    aims.at_most(fmt::format("{}, one thread", scene), 2000, "ns per robot and tick", aims.ns(scene));
  for (const char* scene : {"cave-simple-laser/100", "cave-complex-laser/100"})
    aims.at_most(fmt::format("{}, one thread", scene), 5000, "ns per robot and tick", aims.ns(scene));
  aims.at_most("grid-hospital/1000, one thread", 10000, "ns per robot and tick",
               aims.ns("grid-hospital/1000"));
}

void add_instruction_sets(Aims& aims) {
  struct Aim {
    const char* scene;
    double avx512_ns;
    double avx2_ns;
  };
  constexpr Aim k_aims[] = {{"hospital-10cm/10000", 700, 1100},
                            {"hospital/2000", 900, 1400},
                            {"cave-complex/100", 2000, 3000},
                            {"cave-simple-laser/100", 4500, 7000},
                            {"cave-complex-laser/100", 6000, 9000}};
  const auto ns = [&](const char* scene, std::string_view simd) -> std::optional<double> {
    for (const CaseTiming& one : aims.report().cases)
      for (const Timing& timing : one.timings)
        if (timing.run.scene.name == scene && timing.run.simd == simd)
          return timing.ns(median(timing.wall_s));
    return std::nullopt;
  };
  for (const Aim& aim : k_aims) {
    aims.at_most(fmt::format("{}, avx512", aim.scene), aim.avx512_ns, "ns per robot and tick",
                 ns(aim.scene, "avx512"));
    aims.at_most(fmt::format("{}, avx2", aim.scene), aim.avx2_ns, "ns per robot and tick",
                 ns(aim.scene, "avx2"));
    const auto sse4 = ns(aim.scene, "sse4");
    const auto avx2 = ns(aim.scene, "avx2");
    if (sse4 && avx2) aims.at_most(fmt::format("{}, sse4 / avx2", aim.scene), 1.8, "times", *sse4 / *avx2);
  }
}

void add_devices(Aims& aims) {
  aims.at_least("foragers/2000, one thread", 10, "x real time", aims.times_real_time("foragers/2000", 1));
  aims.at_least("harvesters/10000, one thread", 1, "x real time",
                aims.times_real_time("harvesters/10000", 1));
  aims.at_least("pushers/10000, one thread", 1, "x real time", aims.times_real_time("pushers/10000", 1));
  const auto both = aims.ns("radios/10000");
  const auto rangers = aims.ns("radios-off/10000");
  const auto radios = aims.ns("rangers-off/10000");
  if (both && rangers && radios)
    aims.at_most("radios/10000, radio / ranging", 1, "times", (*both - *rangers) / (*both - *radios));
}

void add_threads(Aims& aims) {
  const std::vector<Scaling> scaling = scalings(aims.report());
  std::optional<double> least;
  std::string slowest;
  for (const Scaling& s : scaling) {
    if (s.timing->run.threads != 2) continue;
    const std::string& scene = s.timing->run.scene.name;
    if (s.speedup < least.value_or(1e9)) {
      least = s.speedup;
      slowest = scene;
    }
    if (s.timing->robots < 10000) continue;
    aims.at_least(fmt::format("{}, speed-up of two threads", scene), 1.75, "times", s.speedup);
    aims.at_least(fmt::format("{}, speed-up of two threads / probe", scene), 95, "%",
                  100 * s.speedup / s.probe);
  }
  aims.at_least(fmt::format("least speed-up of two threads: {}", slowest), 1, "times", least);
  aims.at_least("hospital-10cm/100000, two threads", 2, "x real time",
                aims.times_real_time("hospital-10cm/100000", 2));
  aims.at_least("campus/1000000, two threads", 0.2, "x real time", aims.times_real_time("campus/1000000", 2));
}

void add_clusters(Aims& aims) {
  for (const char* scene : {"hospital/2000", "hospital-10cm/100000"}) {
    const auto dispersed = aims.ns(fmt::format("dispersed-{}", scene));
    const auto clustered = aims.ns(fmt::format("clustered-{}", scene));
    if (dispersed && clustered)
      aims.at_most(fmt::format("{}, clustered / dispersed", scene), 2, "times", *clustered / *dispersed);
  }
}

void add_watching(Aims& aims) {
  const std::pair<Watch, double> limits[] = {
      {Watch::hashes, 5}, {Watch::recording, 15}, {Watch::measures, 100}};
  for (const CaseTiming& one : aims.report().cases)
    for (const Timing& timing : one.timings)
      for (const auto& [watch, limit] : limits)
        if (const auto cost = watching_cost(one, timing); cost && timing.run.watch == watch)
          aims.at_most(fmt::format("{}, {} in every tick, {} thread{}", timing.run.scene.name,
                                   watch_name(watch), timing.run.threads, timing.run.threads > 1 ? "s" : ""),
                       limit, "% of the run", 100 * *cost);
}

void add_memory_and_loading(Aims& aims) {
  const auto rss = [](const ChildReport& r) { return r.rss_bytes; };
  const auto load = [](const ChildReport& r) { return r.read_s + r.build_s; };
  const Report& report = aims.report();
  const auto empty = of_child(child(report, "hospital-10cm/0", false), rss);
  const auto full = of_child(child(report, "hospital-10cm/100000", false), rss);
  if (empty) aims.at_most("memory of the empty hospital", 40, "MB", *empty / 1e6);
  if (empty && full) aims.at_most("additional memory per minibot", 600, "bytes", (*full - *empty) / 100000);
  const ChildTiming* million = child(report, "campus/1000000", false);
  if (million)
    aims.at_most("peak memory of a million minibots", 1500, "MB",
                 *of_child(million, [](const ChildReport& r) { return r.peak_bytes; }) / 1e6);
  aims.at_most("loading 100,000 robots of .world text", 1.5, "s",
               of_child(child(report, "hospital-10cm/100000", true), load));
  aims.at_most("loading 100,000 robots with radios", 2, "s",
               of_child(child(report, "radios/100000", false), load));
  aims.at_most("loading a million robots of populations", 2, "s", of_child(million, load));
}

}  // namespace

Sheet aims_sheet(const Report& report) {
  Aims aims(report);
  add_costs(aims);
  add_instruction_sets(aims);
  add_devices(aims);
  add_threads(aims);
  add_clusters(aims);
  add_watching(aims);
  add_memory_and_loading(aims);
  return std::move(aims).sheet();
}

}  // namespace troupe::perf
