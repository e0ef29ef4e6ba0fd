#include "tests/support/scenes.hpp"
#include "tests/support/paths.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <stdexcept>

namespace troupe::scenes {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Keys = std::vector<std::string_view>;

// The keys of a row. What this file does not read is checked by scripts/proofs/scenes.py.
const Keys k_row_keys = {"world",  "moves", "for",  "excluded", "slow", "prove",
                         "golden", "tests", "perf", "gallery",  "soak"};
const Keys k_benchmark_keys = {"table", "robots", "quick", "populations", "for_s", "beside", "as_text"};

/// The suites that take their worlds from the manifest, and what each of their runs may say.
const std::map<std::string, Keys, std::less<>> k_suites = {
    {"allocations", {"warm_ticks", "ticks"}},
    {"checkpoint", {"robots", "robots_slow", "ranging"}},
    {"convert", {"ticks"}},
    {"energy", {}},
    {"experiments", {}},
    {"grips", {}},
    {"lint", {}},
    {"reset", {"ranging", "threads"}},
    {"same_bits", {"robots", "ticks", "ranging"}},
    {"same_bits_slow", {"robots", "ticks", "ranging"}},
    {"store", {"robots_slow"}},
};

/// Reads values of one file; every message names it and the JSON pointer of the value.
class Reader {
 public:
  explicit Reader(const fs::path& file) : file_(file) {}

  [[noreturn]] void refuse(const std::string& at, const std::string& what) const {
    throw std::runtime_error(fmt::format("{}: error: {}: {}", file_.string(), at.empty() ? "/" : at, what));
  }
  void check_keys(const std::string& at, const Json& object, const Keys& known) const {
    if (!object.is_object()) refuse(at, fmt::format("expected an object, found {}", object.dump()));
    for (const auto& [key, value] : object.items())
      if (std::ranges::find(known, key) == known.end())
        refuse(fmt::format("{}/{}", at, key), fmt::format("unknown key; known: {}", fmt::join(known, ", ")));
  }
  const Json& list(const std::string& at, const Json& value) const {
    if (!value.is_array()) refuse(at, fmt::format("expected a list, found {}", value.dump()));
    return value;
  }
  template <class T>
  T value(const std::string& at, const Json& object, const char* key) const {
    if (!object.contains(key)) refuse(at, fmt::format("the key \"{}\" is missing", key));
    return convert<T>(fmt::format("{}/{}", at, key), object.at(key));
  }
  template <class T>
  std::optional<T> optional(const std::string& at, const Json& object, const char* key) const {
    return object.contains(key) ? std::optional(value<T>(at, object, key)) : std::nullopt;
  }
  template <class T>
  std::vector<T> values(const std::string& at, const Json& object, const char* key) const {
    std::vector<T> all;
    if (!object.contains(key)) return all;
    for (const Json& one : list(fmt::format("{}/{}", at, key), object.at(key)))
      all.push_back(convert<T>(fmt::format("{}/{}/{}", at, key, all.size()), one));
    return all;
  }

 private:
  template <class T>
  T convert(const std::string& at, const Json& value) const {
    if constexpr (std::is_same_v<T, std::string>) {
      if (!value.is_string()) refuse(at, fmt::format("expected a text, found {}", value.dump()));
    } else if constexpr (std::is_same_v<T, bool>) {
      if (!value.is_boolean()) refuse(at, fmt::format("expected true or false, found {}", value.dump()));
    } else if constexpr (std::is_integral_v<T>) {
      if (!value.is_number_unsigned())
        refuse(at, fmt::format("expected a whole number, found {}", value.dump()));
    } else {
      if (!value.is_number()) refuse(at, fmt::format("expected a number, found {}", value.dump()));
    }
    return value.get<T>();
  }

  fs::path file_;
};

Run run_of(const Reader& reader, const std::string& at, const Json& value, const std::string& world,
           const Keys& keys) {
  reader.check_keys(at, value, keys);
  Run run{.world = world};
  if (const auto ranging = reader.optional<std::string>(at, value, "ranging")) {
    if (*ranging != "grid") reader.refuse(at + "/ranging", fmt::format("\"{}\"; known: grid", *ranging));
    run.by_grid = true;
  }
  run.robots = reader.optional<std::size_t>(at, value, "robots");
  run.robots_slow = reader.optional<std::size_t>(at, value, "robots_slow");
  run.warm_ticks = reader.optional<std::uint64_t>(at, value, "warm_ticks").value_or(0);
  if (std::ranges::find(keys, "ticks") != keys.end())
    run.ticks = reader.value<std::uint64_t>(at, value, "ticks");
  run.threads = reader.optional<unsigned>(at, value, "threads").value_or(1);
  return run;
}

void read_tests(const Reader& reader, const std::string& at, const Json& tests, const std::string& world,
                Manifest& manifest) {
  Keys known;
  for (const auto& [suite, keys] : k_suites) known.push_back(suite);
  reader.check_keys(at, tests, known);
  for (const auto& [suite, runs] : tests.items()) {
    const std::string here = fmt::format("{}/{}", at, suite);
    std::vector<Run>& all = manifest.tests[suite];
    std::size_t index = 0;
    for (const Json& run : reader.list(here, runs))
      all.push_back(
          run_of(reader, fmt::format("{}/{}", here, index++), run, world, k_suites.find(suite)->second));
  }
}

Benchmark benchmark_of(const Reader& reader, const std::string& at, const Json& value,
                       const std::string& world) {
  reader.check_keys(at, value, k_benchmark_keys);
  Benchmark benchmark{.world = world,
                      .table = reader.value<std::string>(at, value, "table"),
                      .robots = reader.values<std::size_t>(at, value, "robots"),
                      .quick = reader.values<std::size_t>(at, value, "quick"),
                      .populations = reader.values<std::string>(at, value, "populations"),
                      .for_s = reader.optional<double>(at, value, "for_s"),
                      .beside = {},
                      .as_text = reader.optional<bool>(at, value, "as_text").value_or(false)};
  if (benchmark.robots.empty() || benchmark.quick.empty())
    reader.refuse(at, "needs numbers of robots, \"robots\" and \"quick\"");
  if (!value.contains("beside")) return benchmark;
  for (const Json& one : reader.list(at + "/beside", value.at("beside"))) {
    const std::string here = fmt::format("{}/beside/{}", at, benchmark.beside.size());
    reader.check_keys(here, one, {"name", "set"});
    Variant& variant = benchmark.beside.emplace_back();
    variant.name = reader.value<std::string>(here, one, "name");
    if (!one.contains("set") || !one.at("set").is_object()) reader.refuse(here, "needs an object \"set\"");
    for (const auto& [pointer, text] : one.at("set").items())
      variant.set.emplace_back(pointer,
                               reader.value<std::string>(here + "/set", one.at("set"), pointer.c_str()));
  }
  return benchmark;
}

}  // namespace

fs::path Run::file() const { return test::source_dir() / "worlds" / world; }

std::string Run::name() const {
  std::string name = fs::path(world).stem().string();
  std::erase(name, '-');
  if (by_grid) name += "ByGrid";
  if (world.ends_with(".world")) name += "World";
  if (threads > 1) name += fmt::format("On{}Threads", threads);
  return name;
}

Manifest read_manifest(const fs::path& file) {
  const Reader reader(file);
  std::ifstream stream(file);
  if (!stream) reader.refuse("", "cannot be read");
  Json json;
  try {
    json = Json::parse(stream);
  } catch (const Json::parse_error& error) {
    reader.refuse("", error.what());
  }
  reader.check_keys("", json, {"worlds"});
  Manifest manifest;
  std::set<std::string> seen;
  std::size_t index = 0;
  if (!json.contains("worlds")) reader.refuse("", "the key \"worlds\" is missing");
  for (const Json& row : reader.list("/worlds", json.at("worlds"))) {
    const std::string at = fmt::format("/worlds/{}", index++);
    reader.check_keys(at, row, k_row_keys);
    const auto world = reader.value<std::string>(at, row, "world");
    if (!fs::is_regular_file(file.parent_path() / world))
      reader.refuse(at + "/world",
                    fmt::format("there is no world {} in {}", world, file.parent_path().string()));
    if (!seen.insert(world).second) reader.refuse(at + "/world", fmt::format("{} has two rows", world));
    if (row.contains("tests")) read_tests(reader, at + "/tests", row.at("tests"), world, manifest);
    if (!row.contains("perf")) continue;
    std::size_t line = 0;
    for (const Json& one : reader.list(at + "/perf", row.at("perf")))
      manifest.perf.push_back(benchmark_of(reader, fmt::format("{}/perf/{}", at, line++), one, world));
  }
  return manifest;
}

std::vector<Run> runs_of(std::string_view suite) {
  try {
    const Manifest manifest = read_manifest(test::source_dir() / "worlds" / "scenes.json");
    const auto found = manifest.tests.find(suite);
    if (found == manifest.tests.end() || found->second.empty())
      throw std::runtime_error(fmt::format("worlds/scenes.json: error: no runs of the suite \"{}\"", suite));
    return found->second;
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "{}\n", error.what());
    std::exit(2);
  }
}

}  // namespace troupe::scenes
