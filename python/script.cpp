#include "troupe/script.hpp"

#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "engine/kinds/measure_kind.hpp"
#include "engine/rows/measured_world.hpp"
#include "worldio/files.hpp"
#include "python/robot_batch.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <any>
#include <array>
#include <cstring>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// Controllers and measures that are written in Python. python/troupe/_script.py reads a script and describes
/// them; this file makes kinds of controllers and measures from the descriptions.
namespace troupe::python {
std::string error_text(const py::error_already_set& error, const std::string& file) {
  const py::object text = py::module_::import("troupe._script").attr("error_text");
  const py::object trace = error.trace() ? py::object(error.trace()) : py::object(py::none());
  return text(file, error.value(), trace).cast<std::string>();
}

namespace {

using engine::ControllerKind;
using engine::DecideBatch;

constexpr std::size_t k_most_kinds = 256;  // controllers, and measures, in a process

/// A measure in Python: a function of a swarm that returns a number.
struct PythonMeasure {
  std::string name, text, definition, file;
  py::object function;
};

// The callbacks of a kind are pointers to functions, which cannot store data. Therefore each kind has a
// number, its slot, and a function of its own for this number. Kinds are never released: worlds may refer to
// them until the process ends.
template <class T>
struct Slots {
  static inline std::array<T*, k_most_kinds> all{};
  static inline std::size_t used = 0;

  static std::size_t add(std::unique_ptr<T> one, std::string_view what) {
    if (used == k_most_kinds)
      throw std::length_error(fmt::format(
          "this process has loaded {} {} from Python, and cannot load more: start another process",
          k_most_kinds, what));
    all[used] = one.release();
    return used++;
  }
};

/// Calls a function of a script. An exception of the function becomes a std::runtime_error, whose text names
/// the line, with the exception nested in it (std::nested_exception).
template <class Call>
void call_script(const std::string& file, Call&& function) {
  const py::gil_scoped_acquire lock;
  try {
    function();
  } catch (const py::error_already_set& error) {
    std::throw_with_nested(std::runtime_error(error_text(error, file)));
  } catch (const py::cast_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", file, error.what()));
  }
}

// ---- the callbacks of the kinds

Result<ControllerKind::Prepared> prepare(const PythonController& controller, const engine::Record& params,
                                         std::span<const engine::DeviceInfo> devices) {
  std::vector<std::size_t> chosen;
  if (controller.uses) {
    for (const std::string& wanted : *controller.uses) {
      const auto fits = [&](std::size_t d) {
        return (devices[d].name == wanted || devices[d].kind == wanted) && std::ranges::count(chosen, d) == 0;
      };
      std::size_t d = 0;
      while (d < devices.size() && !fits(d)) ++d;
      if (d == devices.size()) {
        std::vector<std::string_view> names;
        bool is_used_up = false;  // earlier names of the list have taken all devices that fit
        for (const engine::DeviceInfo& device : devices) {
          names.push_back(device.name);
          is_used_up = is_used_up || device.name == wanted || device.kind == wanted;
        }
        return Error{fmt::format(
            "uses the device \"{}\", but no {}device of the type has this name or kind; devices: {}", wanted,
            is_used_up ? "further " : "", names.empty() ? "none" : comma_list(names))};
      }
      chosen.push_back(d);
    }
  } else {
    for (std::size_t d = 0; d < devices.size(); ++d) chosen.push_back(d);
  }
  if (chosen.size() > engine::k_most_devices_read)
    return Error{fmt::format("uses {} devices, but at most {} are allowed: list the needed devices in `uses`",
                             chosen.size(), engine::k_most_devices_read)};
  PreparedController prepared{&controller, {}, params};
  for (const std::size_t d : chosen)
    prepared.devices.push_back({std::string(devices[d].name), devices[d].prepared.percepts,
                                devices[d].prepared.commands, devices[d].prepared.bearings});
  return ControllerKind::Prepared{std::move(prepared), std::move(chosen)};
}

void decide(const std::any& data, const DecideBatch& batch) {
  const auto& prepared = *std::any_cast<PreparedController>(&data);
  call_script(prepared.controller->file, [&] {
    const auto robots = std::make_shared<RobotBatch>(prepared, batch);
    try {
      call(prepared.controller->decide, py::cast(robots));
    } catch (...) {
      robots->close();
      throw;
    }
    robots->finish();
  });
}

template <std::size_t k_slot>
void start(std::byte* memory) {
  const std::string& bytes = Slots<PythonController>::all[k_slot]->start;
  std::memcpy(memory, bytes.data(), bytes.size());
}

template <std::size_t k_slot>
Result<ControllerKind::Prepared> prepare_slot(const engine::Record& params,
                                              std::span<const engine::DeviceInfo> devices,
                                              std::vector<bool>&) {
  return prepare(*Slots<PythonController>::all[k_slot], params, devices);
}

class MeasureInPython : public engine::Measure {
 public:
  MeasureInPython(const PythonMeasure& measure, std::vector<BodyId> robots)
      : measure_(measure), robots_(std::move(robots)) {}

  double value(const engine::MeasuredWorld& world) override {
    double value = 0;
    call_script(measure_.file,
                [&] { value = measured(measure_.function, Swarm::of(engine::whole_world(world), robots_)); });
    return value;
  }

 private:
  const PythonMeasure& measure_;
  std::vector<BodyId> robots_;
};

template <std::size_t k_slot>
std::unique_ptr<engine::Measure> make_measure(const engine::MeasuredWorld&, const engine::Record&,
                                              std::vector<BodyId> robots) {
  return std::make_unique<MeasureInPython>(*Slots<PythonMeasure>::all[k_slot], std::move(robots));
}

using Start = decltype(ControllerKind::start);
using Prepare = decltype(ControllerKind::prepare);
using MakeMeasure = decltype(engine::MeasureKind::make);

template <std::size_t... I>
constexpr auto hooks_of(std::index_sequence<I...>) {
  return std::make_tuple(std::array<Start, k_most_kinds>{&start<I>...},
                         std::array<Prepare, k_most_kinds>{&prepare_slot<I>...},
                         std::array<MakeMeasure, k_most_kinds>{&make_measure<I>...});
}
const auto k_hooks = hooks_of(std::make_index_sequence<k_most_kinds>());

// ---- scripts

engine::Element element_of(const py::dtype& type) {
  for (const auto element :
       {engine::Element::f64, engine::Element::f32, engine::Element::i64, engine::Element::i32,
        engine::Element::u64, engine::Element::u32, engine::Element::u8})
    if (dtype_of(element).equal(type)) return element;
  throw std::logic_error(
      "internal error: a field of a memory has an unknown type; this is no error of your input: please "
      "report it");  // _script.py has checked it
}

std::string_view symbol_of(engine::Unit unit) { return engine::unit_suffixes(unit).front().symbol; }

/// Returns the field of a parameter, whose type follows from its default value (_script.py). The characters
/// of `name` must live as long as the field.
engine::Field parameter_of(std::string_view name, const py::handle& usual) {
  engine::Field field{.name = name};
  if (py::isinstance<py::bool_>(usual)) {
    field.type = engine::FieldType::boolean;
    field.fallback = usual.cast<bool>();
  } else if (py::isinstance<py::int_>(usual)) {
    field.type = engine::FieldType::integer;
    field.fallback = usual.cast<std::int64_t>();
  } else if (py::isinstance<py::float_>(usual)) {
    field.type = engine::FieldType::number;
    field.fallback = usual.cast<double>();
  } else if (py::isinstance<py::str>(usual)) {
    field.type = engine::FieldType::text;
    field.fallback = usual.cast<std::string>();
  } else {
    field.type = engine::FieldType::numbers;
    field.fallback = usual.cast<std::vector<double>>();
  }
  return field;
}

Script::Controller controller_of(const py::dict& described, const std::string& file) {
  auto controller = std::make_unique<PythonController>();
  controller->name = described["name"].cast<std::string>();
  controller->text = described["text"].cast<std::string>();
  controller->file = file;
  controller->decide = described["decide"];
  controller->memory = described["memory"].cast<py::dtype>();
  controller->start = described["start"].cast<std::string>();
  controller->uses = described["uses"].cast<std::optional<std::vector<std::string>>>();
  ControllerKind kind{.name = controller->name, .text = controller->text};
  kind.needs_drive = false;
  kind.is_collective = true;
  for (const py::handle each : described["fields"]) {
    const auto [name, type, columns, offset] =
        each.cast<std::tuple<std::string, py::dtype, std::uint32_t, std::uint32_t>>();
    kind.memory.push_back({.name = name, .element = element_of(type), .columns = columns, .offset = offset});
  }
  const auto params = described["params"].cast<std::vector<std::pair<std::string, py::object>>>();
  for (const auto& [name, usual] : params) controller->params.push_back(name);
  for (std::size_t i = 0; i < params.size(); ++i)
    kind.params.fields.push_back(parameter_of(controller->params[i], params[i].second));
  kind.memory_bytes = controller->start.size();
  kind.decide = &decide;
  Script::Controller made{std::move(kind), described["robots"].cast<std::string>(),
                          described["line"].cast<std::uint32_t>()};
  const std::size_t slot = Slots<PythonController>::add(std::move(controller), "controllers");
  made.kind.start = std::get<0>(k_hooks)[slot];
  made.kind.prepare = std::get<1>(k_hooks)[slot];
  return made;
}

engine::MeasureKind measure_of(const py::dict& described, const std::string& file) {
  auto measure = std::make_unique<PythonMeasure>();
  measure->name = described["name"].cast<std::string>();
  measure->text = described["text"].cast<std::string>();
  measure->definition = described["definition"].cast<std::string>();
  measure->file = file;
  measure->function = described["function"];
  engine::MeasureKind kind{.name = measure->name, .unit = unit_of(described["unit"].cast<std::string>())};
  kind.text = measure->text;
  kind.definition = measure->definition;
  kind.is_foreign = true;
  kind.make = std::get<2>(k_hooks)[Slots<PythonMeasure>::add(std::move(measure), "measures")];
  return kind;
}

std::shared_ptr<const Script> script_of(const py::dict& described) {
  auto script = std::make_shared<Script>();
  script->file = described["file"].cast<std::string>();
  script->contents = hash_text(worldio::read_file(script->file).value_or(""));
  const std::string file = script->file.string();
  for (const py::handle each : described["controllers"])
    script->controllers.push_back(controller_of(each.cast<py::dict>(), file));
  for (const py::handle each : described["measures"])
    script->measures.push_back(measure_of(each.cast<py::dict>(), file));
  return script;
}

}  // namespace

engine::Unit unit_of(const std::string& symbol) {
  for (const engine::Unit unit : engine::all_units())
    if (symbol_of(unit) == symbol) return unit;
  return engine::Unit::none;
}

std::vector<std::shared_ptr<const Script>> scripts_of(const py::object& sources) {
  std::vector<std::shared_ptr<const Script>> scripts;
  for (const py::handle each : py::module_::import("troupe._script").attr("load")(sources)) {
    const auto described = each.cast<py::dict>();
    if (!described.contains("script"))
      described["script"] =
          py::capsule(new std::shared_ptr<const Script>(script_of(described)),
                      [](void* kept) { delete static_cast<std::shared_ptr<const Script>*>(kept); });
    scripts.push_back(*described["script"].cast<py::capsule>().get_pointer<std::shared_ptr<const Script>>());
  }
  return scripts;
}

void bind_scripts(py::module_& module) {
  module.def(
      "_units",
      [] {
        std::vector<std::string> symbols;
        for (const engine::Unit unit : engine::all_units()) symbols.emplace_back(symbol_of(unit));
        return symbols;
      },
      "The units that a measure may have.");
}

}  // namespace troupe::python
