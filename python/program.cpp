#include "apps/command_line.hpp"
#include "apps/observers/filming.hpp"
#include "apps/outputs.hpp"
#include "apps/pictures/film.hpp"
#include "apps/replay.hpp"
#include "apps/scripts.hpp"
#include "base/diagnostics.hpp"
#include "troupe/simulation_source.hpp"
#include "python/bindings.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Functions of the program `troupe` for the Python package: films, replay pages and the whole command line.
namespace troupe::python {
namespace {

/// A film of a simulation; `filming` is null after the `with` block.
struct Film {
  Holder held;
  std::unique_ptr<apps::Filming> filming;
};

/// Throws OutputError if `file` cannot be written, or if the simulation was loaded from this file.
void check_output(const Holder& held, const std::filesystem::path& file) {
  std::vector<apps::Input> inputs;
  apps::add_inputs(held->use(), inputs);
  apps::check_outputs(inputs, {file});
}

Film film_of(const Holder& held, const std::filesystem::path& file, double speed, double fps,
             const PictureOptions& look) {
  const apps::PictureFiles files{.film = file, .fps = fps, .film_speed = speed, .look = look};
  Film film{held, std::make_unique<apps::Filming>(files, SimulationSource(held->use()))};
  check_output(held, file);
  apps::check_film(files);
  film.filming->open();
  return film;
}

}  // namespace

void bind_program(py::module_& module) {
  py::class_<Film> film(
      module, "_Film",
      "A film of a simulation, for a `with` block: the file is written only if the block raises no "
      "exception.");
  with_look([&](const auto&... look) {
    film.def(py::init(drawing<const Holder&, const std::filesystem::path&, double, double>(&film_of)),
             py::arg("simulation"), py::arg("file"), py::arg("speed"), py::arg("fps"), py::arg("width"),
             py::arg("height"), look...);
  });
  film.def("__enter__", [](py::object self) { return self; })
      .def("__exit__",
           [](Film& ending, const py::object& type, const py::args&) {
             std::unique_ptr<apps::Filming> ended = std::move(ending.filming);
             const Unlocked unlocked;
             if (type.is_none()) ended->finish();
             ended.reset();
           })
      .def("observe", [](Film& own) {
        own.held->work([&](Simulation& simulation) { own.filming->observe(simulation); });
      });

  module.def("_check_output", &check_output, py::arg("simulation"), py::arg("file"),
             "Raises RuntimeError if a file of this name cannot be written, or if the simulation was loaded "
             "from this file.");
  module.def(
      "_write_replay_page",
      [](const std::filesystem::path& recording, const std::filesystem::path& page, bool replace) {
        const Unlocked unlocked;
        apps::write_replay_page({.recording = recording, .page = page, .force = replace});
      },
      py::arg("recording"), py::arg("page"), py::arg("replace"),
      "Writes a page that plays a recording in a browser.");

  module.def(
      "_run_program",
      [](const std::vector<std::string>& arguments) {
        apps::set_script_reader([](const std::filesystem::path& file) {
          const py::gil_scoped_acquire lock;
          try {
            return scripts_of(py::cast(file)).front();
          } catch (const py::error_already_set& error) {
            // Exceptions that are not derived from Exception, such as KeyboardInterrupt, are not replaced by
            // an InputError, which names the file.
            const bool names_file = error.matches(py::module_::import("troupe").attr("InputError"));
            throw InputError(names_file ? std::string(py::str(error.value()))
                                        : error_text(error, file.string()));
          }
        });
        std::vector<const char*> words;
        for (const std::string& argument : arguments) words.push_back(argument.c_str());
        words.push_back(nullptr);
        const Unlocked unlocked;
        return apps::run_command_line(static_cast<int>(arguments.size()), words.data());
      },
      py::arg("arguments"),
      "Runs the program `troupe` with these arguments, the first of which is its name, and returns its exit "
      "code.");
}

}  // namespace troupe::python
