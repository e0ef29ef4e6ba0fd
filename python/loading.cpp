#include "base/diagnostics.hpp"
#include "partition/parallel.hpp"
#include "worldio/load.hpp"
#include "python/bindings.hpp"
#include "python/whole_numbers.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::python {

std::string json_of(const py::object& value, const py::object& indent) {
  return py::module_::import("troupe._json")
      .attr("text_of")(value, py::arg("indent") = indent)
      .cast<std::string>();
}

std::vector<std::filesystem::path> folders_of(Paths paths) {
  if (auto* folder = std::get_if<std::filesystem::path>(&paths)) return {std::move(*folder)};
  return std::get<std::vector<std::filesystem::path>>(std::move(paths));
}

namespace {

namespace fs = std::filesystem;

/// Converts a value of the option `set` to JSON. Throws ValueError for a number that is not finite, and for a
/// text with half of a surrogate pair: its JSON is invalid, and the reader of settings treats invalid JSON as
/// a text without quotes.
std::string setting_of(const std::string& pointer, const py::object& value) {
  const py::object text_of = py::module_::import("troupe._json").attr("text_of");
  auto json = text_of(value, py::arg("at") = pointer).cast<std::string>();
  const py::object text = text_of(value, py::arg("ensure_ascii") = false);
  if (PyUnicode_AsUTF8(text.ptr()) != nullptr) return json;
  PyErr_Clear();
  throw py::value_error(fmt::format(
      "set: the value {} contains half of a surrogate pair: give a text that UTF-8 can represent", json));
}

/// The option `set`: a dict from JSON pointers to values, or a list of pairs (JSON pointer, value), in which
/// a pointer such as /models/- may occur several times.
using Settings = std::optional<std::variant<py::dict, py::list>>;

/// Converts the option `set` to pairs of pointer and JSON text.
std::vector<std::pair<std::string, std::string>> settings_of(const Settings& set) {
  std::vector<std::pair<std::string, std::string>> settings;
  if (!set) return settings;
  const auto add = [&settings](const py::handle& pointer, const py::handle& value) {
    try {
      auto at = pointer.cast<std::string>();
      std::string json = setting_of(at, py::reinterpret_borrow<py::object>(value));
      settings.emplace_back(std::move(at), std::move(json));
    } catch (const py::cast_error&) {
      throw py::type_error(fmt::format("set: the key {} is not a JSON pointer: give a text such as \"/seed\"",
                                       short_repr(pointer)));
    }
  };
  if (const py::dict* named = std::get_if<py::dict>(&*set)) {
    for (const auto& [pointer, value] : *named) add(pointer, value);
    return settings;
  }
  for (const py::handle each : std::get<py::list>(*set)) {
    if (!py::isinstance<py::tuple>(each) || py::len(each) != 2)
      throw py::type_error(fmt::format(
          "set: the list has the element {}: give tuples of a JSON pointer and a value", short_repr(each)));
    const auto pair = py::reinterpret_borrow<py::tuple>(each);
    add(pair[0], pair[1]);
  }
  return settings;
}

/// Converts the option `robots`: the size of the only population, a dict from names of populations to sizes,
/// or None.
std::vector<std::pair<std::string, std::size_t>> robots_of(const py::object& robots) {
  if (robots.is_none()) return {};
  const std::string allowed =
      fmt::format("a whole number from 0 to {:.0f}", worldio::LoadOptions{}.most_bodies);
  if (!py::isinstance<py::dict>(robots))
    return {{"", whole_number("robots", robots,
                              allowed + ", or a dict from names of populations to such numbers")}};
  std::vector<std::pair<std::string, std::size_t>> sizes;
  for (const auto& [name, count] : robots.cast<py::dict>()) {
    if (!py::isinstance<py::str>(name))
      throw py::type_error(
          fmt::format("robots: found the key {}: give the name of a population", short_repr(name)));
    sizes.emplace_back(name.cast<std::string>(),
                       whole_number(fmt::format("robots[{}]", short_repr(name)),
                                    py::reinterpret_borrow<py::object>(count), allowed));
  }
  return sizes;
}

std::optional<RangingEngine> ranging_of(const std::optional<std::string>& name) {
  if (!name) return {};
  const auto found = std::ranges::find(engine::k_ranging_engines, *name);
  if (found == engine::k_ranging_engines.end())
    throw std::invalid_argument(
        unknown_name("ranging", *name, {engine::k_ranging_engines.begin(), engine::k_ranging_engines.end()}));
  return static_cast<RangingEngine>(found - engine::k_ranging_engines.begin());
}

double tile_size(double metres) {
  return from_zero("tile_size_m", metres, std::numeric_limits<double>::max());
}

/// Converts the option `threads` or `ranks`. Simulation rejects numbers above `most`, and 0 ranks.
unsigned count_of(std::string_view name, const py::object& count, unsigned least, unsigned most) {
  const std::string allowed = fmt::format("a whole number from {} to {}", least, most);
  const std::uint64_t number = whole_number(name, count, allowed);
  if (number > std::numeric_limits<unsigned>::max())
    throw py::value_error(fmt::format("{}: found {}: give {}", name, number, allowed));
  return static_cast<unsigned>(number);
}

using Text = std::optional<std::string>;

SimulationOptions options_of(const py::object& robots, const py::object& threads, const py::object& seed,
                             const Text& ranging, const Settings& set, Paths search_path, Paths plugin_path,
                             const py::object& controllers, double tile_size_m, const py::object& ranks) {
  return {.threads = count_of("threads", threads, 0, partition::Parallel::k_most_threads),
          .tile_size_m = tile_size(tile_size_m),
          .seed = optional_seed_of(seed),
          .ranging = ranging_of(ranging),
          .robots = robots_of(robots),
          .set = settings_of(set),
          .search_path = folders_of(std::move(search_path)),
          .plugin_path = folders_of(std::move(plugin_path)),
          .scripts = scripts_of(controllers),
          .ranks = count_of("ranks", ranks, 1, k_most_ranks)};
}

/// Returns the simulation that make() makes. make() runs without the interpreter's lock, because worlds may
/// take long to load.
template <class Make>
Holder hold(Make&& make) {
  const Unlocked unlocked;
  return std::make_shared<Held>(make());
}

Holder load(const std::variant<py::dict, fs::path>& world, const py::object& robots,
            const py::object& threads, const py::object& seed, const Text& ranging, const Settings& set,
            const fs::path& name, Paths search_path, Paths plugin_path, const py::object& controllers,
            double tile_size_m, const py::object& ranks) {
  const SimulationOptions options = options_of(robots, threads, seed, ranging, set, std::move(search_path),
                                               std::move(plugin_path), controllers, tile_size_m, ranks);
  std::error_code ignored;
  if (const fs::path* file = std::get_if<fs::path>(&world)) {
    if (file->native().find_first_of("{\n") != std::string::npos && !fs::exists(*file, ignored))
      throw py::value_error(
          "world: found the text of a world where the name of a file is expected: use "
          "Simulation.from_text()");
    return hold([&] { return Simulation(*file, options); });
  }
  const std::string text = json_of(std::get<py::dict>(world), py::int_(1));
  try {
    return hold([&] { return Simulation::from_text(text, name, options); });
  } catch (const InputError& error) {
    throw InputError(py::module_::import("troupe._json")
                         .attr("without_lines")(decoded(error.what()), decoded(name.string()))
                         .attr("encode")("utf-8", "surrogateescape")
                         .cast<std::string>());
  }
}

Holder from_text(const std::string& text, const fs::path& name, const py::object& robots,
                 const py::object& threads, const py::object& seed, const Text& ranging, const Settings& set,
                 Paths search_path, Paths plugin_path, const py::object& controllers, double tile_size_m,
                 const py::object& ranks) {
  const SimulationOptions options = options_of(robots, threads, seed, ranging, set, std::move(search_path),
                                               std::move(plugin_path), controllers, tile_size_m, ranks);
  return hold([&] { return Simulation::from_text(text, name, options); });
}

Holder resume(const fs::path& checkpoint, const py::object& threads, const Settings& set,
              bool across_versions, Paths plugin_path, const py::object& controllers, bool across_plugins,
              double tile_size_m, const py::object& ranks) {
  const ResumeOptions options{.threads = count_of("threads", threads, 0, partition::Parallel::k_most_threads),
                              .tile_size_m = tile_size(tile_size_m),
                              .set = settings_of(set),
                              .across_versions = across_versions,
                              .plugin_path = folders_of(std::move(plugin_path)),
                              .scripts = scripts_of(controllers),
                              .across_plugins = across_plugins,
                              .ranks = count_of("ranks", ranks, 1, k_most_ranks)};
  return hold([&] { return Simulation::resume(checkpoint, options); });
}

}  // namespace

void bind_loading(SimulationClass& simulation) {
  simulation
      .def(
          py::init(&load), py::arg("world"), py::kw_only(), py::arg("robots") = py::none(),
          py::arg("threads") = 0, py::arg("seed") = py::none(), py::arg("ranging") = py::none(),
          py::arg("set") = py::none(), py::arg("name") = "dict.json", py::arg("search_path") = py::tuple(),
          py::arg("plugin_path") = py::tuple(), py::arg("controllers") = py::tuple(),
          py::arg("tile_size_m") = 0.0, py::arg("ranks") = 1,
          "Loads a world. world: a file name (Stage .world or JSON), or a dict with the content of a JSON "
          "world file, whose\nrelative paths are resolved from the folder of `name`. robots: number of "
          "robots of the only population, or a dict from\nnames of populations to numbers of robots. "
          "threads: number of worker threads, at most 1024; 0: one per processor that\nthe process may use. "
          "ranks: number of ranks; each rank is a group of `threads` threads of this process that has its "
          "own\ncopy of the world and computes some of the robots (docs/cluster.md); no result depends on "
          "this number. seed and ranging\n(\"exact\" or \"grid\") replace the values of the world file. "
          "set: other values of the world file to replace, a dict from\nJSON pointers to new values, or a "
          "list of tuples (JSON pointer, new value), in which /models/- and other pointers to\nthe end of a "
          "list may occur several times. controllers: a script (file name), a class derived from Controller, "
          "or a\nlist of these. search_path: folders in which the world file and included files are searched "
          "by their names if they do\nnot exist at their paths. plugin_path: folders in which plug-ins are "
          "searched. Either may also be a single folder.\ntile_size_m: edge length of the tiles of the "
          "spatial index, m, which affects only the speed; 0: automatic. Raises\nInputError if the world is "
          "invalid.")
      .def_static(
          "from_text", &from_text, py::arg("text"), py::arg("name") = "text.json", py::kw_only(),
          py::arg("robots") = py::none(), py::arg("threads") = 0, py::arg("seed") = py::none(),
          py::arg("ranging") = py::none(), py::arg("set") = py::none(), py::arg("search_path") = py::tuple(),
          py::arg("plugin_path") = py::tuple(), py::arg("controllers") = py::tuple(),
          py::arg("tile_size_m") = 0.0, py::arg("ranks") = 1,
          "Loads a world from the text of a world file. `name` is used in place of a file name: its ending, "
          ".world or\n.json, selects the syntax, and relative paths are resolved from its folder. The other "
          "parameters are those of\nSimulation(). Raises InputError if the world is invalid.")
      .def_static("resume", &resume, py::arg("checkpoint"), py::kw_only(), py::arg("threads") = 0,
                  py::arg("set") = py::none(), py::arg("across_versions") = false,
                  py::arg("plugin_path") = py::tuple(), py::arg("controllers") = py::tuple(),
                  py::arg("across_plugins") = false, py::arg("tile_size_m") = 0.0, py::arg("ranks") = 1,
                  "Resumes a run from a checkpoint of save(), with the same results, bit for bit, as if "
                  "it had never stopped. set: as in\nSimulation(), for values of the world that may "
                  "change in a resumed run (docs/checkpoints.md). plugin_path, controllers:\nas in "
                  "Simulation(); they must contain all plug-ins and scripts that the run used. threads, "
                  "tile_size_m, ranks: as in\nSimulation(). across_versions: whether a checkpoint of "
                  "another version of Troupe is accepted. across_plugins: whether\nplug-ins and scripts "
                  "are accepted whose files have changed since the checkpoint was saved. Raises "
                  "InputError if the file\nis not a usable checkpoint, or if a plug-in or script of the "
                  "run is missing.")
      .def("__repr__", [](const Holder& held) {
        Simulation& s = held->use();
        return decoded(
            fmt::format("<Simulation \"{}\": {} robots, {:g} s>", s.title(), s.robots(), s.time_s()));
      });
}

}  // namespace troupe::python
