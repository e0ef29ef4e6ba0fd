// This file reads studies for troupe.sweep(), as the program `troupe sweep` does.

#include "worldio/json/study.hpp"
#include "base/diagnostics.hpp"
#include "engine/spec/ticks.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "python/bindings.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::python {
namespace {

py::dict read_study(const std::filesystem::path& file, const std::optional<std::string>& text,
                    const std::optional<std::string>& world, Paths plugin_path,
                    const py::object& controllers) {
  using namespace py::literals;
  engine::Registry registry = make_registry();
  add_plugins(registry, folders_of(std::move(plugin_path)), scripts_of(controllers));
  Diagnostics diagnostics;
  const auto files = diagnostics.files();
  const worldio::Study study =
      text ? worldio::load_study_text(file, *text, registry, diagnostics, world ? &*world : nullptr)
           : worldio::load_study(file, registry, diagnostics);
  diagnostics.throw_if_errors();
  py::list parameters;
  for (const worldio::Study::Parameter& parameter : study.parameters)
    parameters.append(py::make_tuple(parameter.name, parameter.pointer));
  py::list statistics;
  for (const worldio::Statistic statistic : study.statistics)
    statistics.append(std::string(worldio::statistic_name(statistic)));
  py::list runs;
  for (std::size_t r = 0; r < study.run_count(); ++r) {
    const worldio::Study::Run run = study.run(r);
    runs.append(py::make_tuple(run.values, run.seed));
  }
  const py::cpp_function check([study, files](const std::vector<std::string>& measures) {
    Diagnostics found(files);
    worldio::check_columns(study, measures, found);
    found.throw_if_errors();
  });
  const py::cpp_function seed_of([study](std::size_t run, std::uint64_t world_seed) {
    return study.seed_of(study.run(run), world_seed);
  });
  return py::dict("world"_a = decoded(study.world.string()), "for_s"_a = study.for_s,
                  "parameters"_a = parameters, "measures"_a = study.measures, "statistics"_a = statistics,
                  "measure_every_s"_a = study.measure_every_s, "series"_a = study.series, "runs"_a = runs,
                  "check_columns"_a = check, "seed_of"_a = seed_of);
}

}  // namespace

void bind_study(py::module_& module) {
  module.def(
      "_read_study", &read_study, py::arg("file"), py::arg("text") = py::none(),
      py::arg("world") = py::none(), py::arg("plugin_path") = py::tuple(),
      py::arg("controllers") = py::tuple(),
      "Reads a study of `troupe sweep` and returns it as a dict. text: the text of the study, if it "
      "is no file. world: the\n"
      "text of its world, if that is no file. plugin_path, controllers: as in Simulation(); the study "
      "may name their measures.\n"
      "The item \"runs\" is a list with one pair per run: the values of the parameters, as JSON texts, "
      "and the seed. Its\n"
      "item \"check_columns\" is a function of the names of the measures, which raises InputError if "
      "two columns of the results\n"
      "would have the same name. Its item \"seed_of\" is a function of the index of a run and of the seed "
      "of the world,\n"
      "which returns the seed of the run, or None if the value of the parameter that sets it is no seed.");
  module.def(
      "_runs_text", [](const std::vector<std::size_t>& runs) { return worldio::runs_text(runs); },
      py::arg("runs"));
  module.def("_ticks_until", &engine::ticks_until, py::arg("end_s"), py::arg("tick_s"));
  module.def("_period_ticks", &engine::period_ticks, py::arg("period_s"), py::arg("tick_s"));
}

}  // namespace troupe::python
