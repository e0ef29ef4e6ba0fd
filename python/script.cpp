#include "troupe/script.hpp"

#include "apps/command_line.hpp"
#include "apps/observers/filming.hpp"
#include "apps/outputs.hpp"
#include "apps/pictures/film.hpp"
#include "apps/replay.hpp"
#include "apps/scripts.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "engine/observing/measures.hpp"
#include "troupe/simulation_source.hpp"
#include "worldio/files.hpp"
#include "python/bindings.hpp"
#include "python/columns.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <any>
#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// Controllers and measures that are written in Python. python/troupe/_script.py reads a script and describes
/// them; this file makes kinds of controllers and measures from the descriptions.
namespace troupe::python {
namespace {

using engine::ControllerKind;
using engine::DecideBatch;
using engine::StateField;

constexpr std::size_t k_most_kinds = 64;  // controllers, and measures, in a process

/// A controller in Python. The memory of its robots is owned by the engine.
struct PythonController {
  std::string name, text, file;
  py::object decide;                             ///< a bound method: decide(robots)
  py::dtype memory;                              ///< structured type of the memory of one robot
  std::string start;                             ///< initial bytes of the memory of one robot
  std::optional<std::vector<std::string>> uses;  ///< names or kinds of the devices; not set: all
  std::vector<std::string> params;               ///< names of the parameters
};

/// A measure in Python: a function of a swarm that returns a number.
struct PythonMeasure {
  std::string name, text, file;
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

/// Returns the text of a Python exception, with the line of the script in which it was raised.
std::string error_text(const py::error_already_set& error, const std::string& file) {
  const py::object text = py::module_::import("troupe._script").attr("error_text");
  const py::object trace = error.trace() ? py::object(error.trace()) : py::object(py::none());
  return text(file, error.value(), trace).cast<std::string>();
}

/// Calls a function of a script. Its exceptions become std::runtime_error, whose text names the line.
template <class Call>
void call_script(const std::string& file, Call&& function) {
  const py::gil_scoped_acquire lock;
  try {
    function();
  } catch (const py::error_already_set& error) {
    throw std::runtime_error(error_text(error, file));
  } catch (const py::cast_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", file, error.what()));
  }
}

/// A device that a controller uses. Its index in PreparedController::devices is also its index in the arrays
/// of DecideBatch.
struct UsedDevice {
  std::string name;
  std::vector<StateField> readings, command;
  std::vector<double> bearings;  ///< of the beams, rad, frame of the ranger; empty for other devices
};

/// The content of ControllerKind::Prepared::data for a controller in Python.
struct PreparedController {
  const PythonController* controller;
  std::vector<UsedDevice> devices;
  engine::Record params;  ///< a value for each of PythonController::params
};

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

/// Returns the value of a parameter of a controller. A list becomes a tuple.
py::object object_of(const engine::Value& value) {
  if (const auto* x = std::get_if<bool>(&value.v)) return py::bool_(*x);
  if (const auto* x = std::get_if<std::int64_t>(&value.v)) return py::int_(*x);
  if (const auto* x = std::get_if<double>(&value.v)) return py::float_(*x);
  if (const auto* x = std::get_if<std::string>(&value.v)) return py::str(*x);
  return py::tuple(py::cast(std::get<std::vector<double>>(value.v)));
}

/// The robots of a call of decide(). The object can be used only during this call.
class RobotBatch {
 public:
  RobotBatch(const PreparedController& prepared, const DecideBatch& batch)
      : prepared_(prepared), batch_(&batch) {
    const auto row = static_cast<std::size_t>(prepared.controller->memory.itemsize());
    if (batch.memories.first == nullptr) return;
    const py::object type = py::module_::import("troupe._script").attr("Memory");
    memory_ = py::array(prepared.controller->memory, std::vector<py::ssize_t>{size()}).attr("view")(type);
    for (std::size_t i = 0; i < batch.size(); ++i)
      std::memcpy(static_cast<std::byte*>(memory_.mutable_data()) + i * row, batch.memory(i), row);
  }

  /// Copies the array `memory` to the engine. The object cannot be used afterwards.
  void finish() {
    const auto row = static_cast<std::size_t>(prepared_.controller->memory.itemsize());
    if (batch_->memories.first != nullptr)
      for (std::size_t i = 0; i < batch_->size(); ++i)
        std::memcpy(batch_->memory(i), static_cast<const std::byte*>(memory_.data()) + i * row, row);
    batch_ = nullptr;
  }
  void close() { batch_ = nullptr; }

  py::ssize_t size() const { return static_cast<py::ssize_t>(batch().size()); }
  const DecideBatch& batch() const {
    if (batch_ == nullptr)
      throw std::logic_error(
          "the argument `robots` of decide() can be used only during the call of decide()");
    return *batch_;
  }
  py::array memory() const {
    batch();
    if (memory_.size() == 0 && prepared_.controller->start.empty())
      throw py::attribute_error("the controller has no memory: declare its fields in `memory`");
    return memory_;
  }
  /// A dict that cannot be changed: a change would not be part of the state.
  py::object params() const {
    batch();
    py::dict values;
    for (std::size_t i = 0; i < prepared_.params.size(); ++i)
      values[py::str(prepared_.controller->params[i])] = object_of(prepared_.params[i]);
    return py::module_::import("types").attr("MappingProxyType")(values);
  }
  py::array_t<std::uint32_t> ids() const {
    py::array_t<std::uint32_t> out(size());
    for (py::ssize_t i = 0; i < size(); ++i) out.mutable_at(i) = batch().body(static_cast<std::size_t>(i));
    return out;
  }
  py::array_t<double> estimates() const {
    py::array_t<double> out({size(), py::ssize_t{4}});
    const std::span<Pose> poses = elements<Pose>(out);
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = batch().estimate(i);
    return out;
  }
  py::array readings(const std::string& field, const std::string& device) const;
  py::array ranges(const std::string& sensor) const;
  py::array_t<double> bearings(const std::string& sensor) const;
  py::dict commands(const std::string& device) const;
  void command(const std::string& device, const Where& where, const py::kwargs& values) const;
  void say(const py::object& message, const std::string& device, const Where& where) const {
    const std::size_t d = device_named(device, true);
    const py::dict values = message_command(prepared_.devices[d].command, device, message, size());
    command(device, where, py::reinterpret_borrow<py::kwargs>(values));
  }
  py::tuple heard(const py::object& type, const std::string& device) const {
    return messages_of(type, device, readings("count", device), readings("length", device),
                       readings("payload", device));
  }
  template <engine::ControlMode k_mode>
  void drive(const Numbers& x, const Numbers& turn, const Numbers& y, const Where& where) const;
  void go_to(const Numbers& x, const Numbers& y, const Numbers& heading, const Where& where) const {
    drive<engine::ControlMode::position>(x, heading, y, where);
  }
  /// An array of the numbers that draw(random) returns for the random stream of each robot.
  template <class T, class Draw>
  py::array_t<T> drawn(Draw&& draw) {
    if (randoms_.empty())
      for (std::size_t i = 0; i < batch().size(); ++i) randoms_.push_back(batch().random(i));
    py::array_t<T> out(size());
    for (std::size_t i = 0; i < randoms_.size(); ++i)
      out.mutable_at(static_cast<py::ssize_t>(i)) = draw(randoms_[i]);
    return out;
  }

 private:
  std::size_t device_named(const std::string& name, bool takes_commands) const;
  std::size_t ranger_named(const std::string& name) const;

  const PreparedController& prepared_;
  const DecideBatch* batch_;
  py::array memory_;             // a row per robot
  std::vector<Random> randoms_;  // a stream per robot, made by the first draw
};

std::size_t RobotBatch::device_named(const std::string& name, bool takes_commands) const {
  std::vector<std::string_view> known;
  for (std::size_t d = 0; d < prepared_.devices.size(); ++d) {
    const UsedDevice& device = prepared_.devices[d];
    if (takes_commands && device.command.empty()) continue;
    if (device.name == name) return d;
    known.push_back(device.name);
  }
  throw std::out_of_range(
      unknown_name(takes_commands ? "device that takes commands" : "device", name, known));
}

py::array RobotBatch::readings(const std::string& field, const std::string& device) const {
  const auto index_in = [&field](const UsedDevice& of) {
    return static_cast<std::size_t>(std::ranges::find(of.readings, field, &StateField::name) -
                                    of.readings.begin());
  };
  std::size_t d = 0;
  if (!device.empty())
    d = device_named(device, false);
  else
    while (d < prepared_.devices.size() &&
           index_in(prepared_.devices[d]) == prepared_.devices[d].readings.size())
      ++d;
  const std::size_t f = d < prepared_.devices.size() ? index_in(prepared_.devices[d]) : 0;
  if (d == prepared_.devices.size() || f == prepared_.devices[d].readings.size()) {
    std::vector<std::string_view> known;
    for (const UsedDevice& each : prepared_.devices)
      if (device.empty() || each.name == device)
        for (const StateField& other : each.readings) known.push_back(other.name);
    throw std::out_of_range(unknown_name("field", field, std::move(known)));
  }
  py::array out = empty_rows(prepared_.devices[d].readings[f], size());
  const std::span<std::byte> to = bytes_of(out);
  const std::size_t bytes = to.size() / std::max<std::size_t>(batch().size(), 1);
  for (std::size_t i = 0; i < batch().size(); ++i)
    std::memcpy(to.data() + i * bytes, batch().percepts[d]->cell<std::byte>(batch().slot(i), f).data(),
                bytes);
  return out;
}

std::size_t RobotBatch::ranger_named(const std::string& name) const {
  if (!name.empty()) return device_named(name, false);
  for (std::size_t d = 0; d < prepared_.devices.size(); ++d)
    if (!prepared_.devices[d].bearings.empty()) return d;
  throw std::out_of_range(
      "the controller uses no ranger: the robots have no ranger, or `uses` does not list one");
}

py::array RobotBatch::ranges(const std::string& sensor) const {
  const UsedDevice& device = prepared_.devices[ranger_named(sensor)];
  const py::array all = readings("ranges", device.name);
  return all.ndim() > 1 ? all : py::array(all.attr("reshape")(-1, 1));
}

py::array_t<double> RobotBatch::bearings(const std::string& sensor) const {
  const std::vector<double>& bearings = prepared_.devices[ranger_named(sensor)].bearings;
  return py::array_t<double>(static_cast<py::ssize_t>(bearings.size()), bearings.data());
}

py::dict RobotBatch::commands(const std::string& device) const {
  const std::size_t d = device_named(device, true);
  py::dict all;
  for (const StateField& field : prepared_.devices[d].command) {
    py::array out = empty_rows(field, size());
    const std::span<std::byte> to = bytes_of(out);
    const std::size_t bytes = to.size() / std::max<std::size_t>(batch().size(), 1);
    for (std::size_t i = 0; i < batch().size(); ++i)
      std::memcpy(to.data() + i * bytes, batch().device_command(d, i) + field.offset, bytes);
    all[py::str(field.name)] = std::move(out);
  }
  return all;
}

void RobotBatch::command(const std::string& device, const Where& where, const py::kwargs& values) const {
  const std::size_t d = device_named(device, true);
  const std::vector<StateField>& fields = prepared_.devices[d].command;
  std::vector<std::pair<const StateField*, py::array>> set;
  for (const auto& [key, value] : values) {
    const std::string name = key.cast<std::string>();
    const StateField& field = command_field(fields, name, fmt::format("device \"{}\"", device));
    set.emplace_back(&field, rows_for(field, value, size()));
  }
  const std::vector<std::uint8_t> mask = mask_of(where, batch().size());
  for (const auto& [field, rows] : set) {
    const std::span<const std::byte> from = const_bytes_of(rows);
    const std::size_t bytes = from.size() / std::max<std::size_t>(batch().size(), 1);
    for (std::size_t i = 0; i < batch().size(); ++i)
      if (mask.empty() || mask[i] != 0)
        std::memcpy(batch().device_command(d, i) + field->offset, from.data() + i * bytes, bytes);
  }
}

template <engine::ControlMode k_mode>
void RobotBatch::drive(const Numbers& x, const Numbers& turn, const Numbers& y, const Where& where) const {
  const std::size_t n = batch().size();
  const bool is_goal = k_mode == engine::ControlMode::position;
  const Column xs(is_goal ? "x" : "forward", x, n);
  const Column ys(is_goal ? "y" : "left", y, n);
  const Column turns(is_goal ? "heading" : "turn", turn, n);
  const std::vector<std::uint8_t> mask = mask_of(where, n);
  for (std::size_t i = 0; i < n; ++i)
    if (mask.empty() || mask[i] != 0) batch().command(i) = {xs[i], ys[i], turns[i], k_mode};
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

/// Makes the swarm that is the argument of a measure unusable when the measure returns.
class ArgumentOfMeasure {
 public:
  explicit ArgumentOfMeasure(Swarm swarm) : object_(py::cast(HeldSwarm{nullptr, std::move(swarm)})) {}
  ~ArgumentOfMeasure() { object_.cast<HeldSwarm&>().is_over = true; }
  ArgumentOfMeasure(const ArgumentOfMeasure&) = delete;
  ArgumentOfMeasure& operator=(const ArgumentOfMeasure&) = delete;

  const py::object& object() const { return object_; }

 private:
  py::object object_;
};

class MeasureInPython : public engine::Measure {
 public:
  MeasureInPython(const PythonMeasure& measure, std::vector<BodyId> robots)
      : measure_(measure), robots_(std::move(robots)) {}

  double value(engine::World& world) override {
    double value = 0;
    call_script(measure_.file, [&] {
      const ArgumentOfMeasure swarm(Swarm::of(world, robots_));
      const py::object result = call(measure_.function, swarm.object());
      value =
          py::module_::import("troupe._script").attr("number_of")(measure_.function, result).cast<double>();
    });
    return value;
  }

 private:
  const PythonMeasure& measure_;
  std::vector<BodyId> robots_;
};

template <std::size_t k_slot>
std::unique_ptr<engine::Measure> make_measure(const engine::World&, const engine::Record&,
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

engine::Unit unit_of(const std::string& symbol) {
  for (auto unit = engine::Unit::meters; unit <= engine::Unit::watts;
       unit = static_cast<engine::Unit>(static_cast<int>(unit) + 1))
    if (engine::unit_suffixes(unit).front().symbol == symbol) return unit;
  return engine::Unit::none;
}

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
  measure->file = file;
  measure->function = described["function"];
  engine::MeasureKind kind{.name = measure->name, .unit = unit_of(described["unit"].cast<std::string>())};
  kind.text = kind.definition = measure->text;
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

void bind_script(py::module_& module) {
  py::class_<RobotBatch, std::shared_ptr<RobotBatch>>(
      module, "Robots",
      "The n robots for which a controller decides, in ascending order of their ids: the argument of "
      "decide(). Functions with\nthe name of a function of Swarm work as that function does, but only with "
      "the devices that the controller uses\n(Controller.uses). The object can be used only during the call "
      "of decide(); later calls raise RuntimeError.")
      .def("__len__", [](const RobotBatch& robots) { return robots.size(); })
      .def_property_readonly("ids", &RobotBatch::ids)
      .def_property_readonly("tick", [](const RobotBatch& robots) { return robots.batch().tick; })
      .def_property_readonly("time_s", [](const RobotBatch& robots) { return robots.batch().time_s; })
      .def_property_readonly("tick_s", [](const RobotBatch& robots) { return robots.batch().tick_s; })
      .def_property_readonly(
          "period_s", [](const RobotBatch& robots) { return robots.batch().period_s; },
          "Time from one decision of a robot to its next one, s.")
      .def_property_readonly(
          "memory", &RobotBatch::memory,
          "The memories of the robots: a structured array with one row per robot and the fields of "
          "Controller.memory. The next call\nof decide() finds the values that this call writes to the "
          "array. Raises AttributeError if the controller declares no\nmemory.")
      .def_property_readonly(
          "params", &RobotBatch::params,
          "The parameters of the controller (Controller.params): a mapping from names to values, which "
          "cannot be changed. Lists are\ntuples.")
      .def("estimates", &RobotBatch::estimates, "Estimated poses, n x 4: x, y, z (m), heading (rad).")
      .def("readings", &RobotBatch::readings, py::arg("field"), py::arg("device") = "",
           "The values of a field of a sensor or another device: shape (n,) or, if the field has several "
           "columns, (n, columns). An\nempty `device` means the first device that has this field. Raises "
           "LookupError for a field or device that does not exist\nor that the controller does not use.")
      .def("ranges", &RobotBatch::ranges, py::arg("sensor") = "",
           "Ranges that the ranger named `sensor` measured, m: n x beams, float32. An empty name means the "
           "first ranger. Raises\nLookupError if the controller uses no such ranger.")
      .def("bearings", &RobotBatch::bearings, py::arg("sensor") = "",
           "Headings of the beams of the ranger named `sensor`, rad, in the frame of the ranger. An empty "
           "name means the first ranger.")
      .def("heard", &RobotBatch::heard, py::arg("dtype"), py::arg("device") = "radio",
           "The messages that the radios named `device` heard in this tick, as Swarm.heard() returns them.")
      .def("commands", &RobotBatch::commands, py::arg("device"),
           "The present commands of the device named `device`, as Swarm.commands() returns them: a dict with "
           "one array per field of\nthe command.")
      .def("command", &RobotBatch::command, py::arg("device"), py::kw_only(), py::arg("where") = py::none(),
           "Sets fields of the commands of the device named `device` by name, as Swarm.command() does.")
      .def("say", &RobotBatch::say, py::arg("message"), py::arg("device") = "radio", py::kw_only(),
           py::arg("where") = py::none(),
           "Sets the messages that the radios named `device` send, as Swarm.say() does.")
      .def("set_speeds", &RobotBatch::drive<engine::ControlMode::velocity>, py::arg("forward").none(false),
           py::arg("turn").none(false), py::kw_only(), py::arg("left").none(false) = 0.0,
           py::arg("where") = py::none(),
           "Commands speeds in the body frame, as Swarm.set_speeds() does: forward and left in m/s, turn in "
           "rad/s.")
      .def("accelerate", &RobotBatch::drive<engine::ControlMode::acceleration>,
           py::arg("forward").none(false), py::arg("turn").none(false), py::kw_only(),
           py::arg("left").none(false) = 0.0, py::arg("where") = py::none(),
           "Commands accelerations in the body frame, as Swarm.accelerate() does: forward and left in m/s^2, "
           "turn in rad/s^2.")
      .def("go_to", &RobotBatch::go_to, py::arg("x").none(false), py::arg("y").none(false),
           py::arg("heading").none(false), py::kw_only(), py::arg("where") = py::none(),
           "Commands goal poses in the frame of estimates(), m and rad.")
      .def(
          "uniform",
          [](RobotBatch& robots, double low, double high) {
            return robots.drawn<double>([&](Random& random) { return random.uniform(low, high); });
          },
          py::arg("low") = 0.0, py::arg("high") = 1.0,
          "One uniformly distributed number in [low, high) per robot, float64. Each call takes the next "
          "number of each robot's\nrandom stream of this tick, as a call of Random::uniform() in a "
          "controller in C++ does.")
      .def(
          "normal",
          [](RobotBatch& robots) {
            return robots.drawn<double>([](Random& random) { return random.normal(); });
          },
          "One normally distributed number with mean 0 and standard deviation 1 per robot, from the same "
          "streams as uniform().")
      .def(
          "exponential",
          [](RobotBatch& robots) {
            return robots.drawn<double>([](Random& random) { return random.exponential(); });
          },
          "One exponentially distributed number with mean 1 per robot, from the same streams as uniform().")
      .def(
          "below",
          [](RobotBatch& robots, std::uint32_t n) {
            if (n == 0) throw py::value_error("below(0): n must be 1 or more");
            return robots.drawn<std::uint32_t>([n](Random& random) { return random.below(n); });
          },
          py::arg("n"),
          "One uniformly distributed integer from 0 to n - 1 per robot, from the same streams as uniform(). "
          "Raises ValueError if n\nis 0.");

  py::class_<Film>(
      module, "_Film",
      "A film of a simulation, for a `with` block: the file is written only if the block raises no "
      "exception.")
      .def(py::init([](const Holder& held, const std::filesystem::path& file, double speed, double fps,
                       int width, int height, const std::string& camera, const std::string& layers,
                       const Two& center_m, const Two& angle_rad, const std::optional<double>& across_m,
                       const std::string& color_by, const Two& color_range, const std::string& background) {
             const apps::PictureFiles files{
                 .film = file,
                 .fps = fps,
                 .film_speed = speed,
                 .look = picture_options(width, height, camera, layers, center_m, angle_rad, across_m,
                                         color_by, color_range, background)};
             Film film{held, std::make_unique<apps::Filming>(files, SimulationSource(held->use()))};
             check_output(held, file);
             apps::check_film(files);
             film.filming->open();
             return film;
           }),
           py::arg("simulation"), py::arg("file"), py::arg("speed"), py::arg("fps"), py::arg("width"),
           py::arg("height"), py::kw_only(), py::arg("camera") = "top", py::arg("layers") = "",
           py::arg("center_m") = py::none(), py::arg("angle_rad") = py::none(),
           py::arg("across_m") = py::none(), py::arg("color_by") = "", py::arg("color_range") = py::none(),
           py::arg("background") = "paper")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__",
           [](Film& film, const py::object& type, const py::args&) {
             std::unique_ptr<apps::Filming> ended = std::move(film.filming);
             const Unlocked unlocked;
             if (type.is_none()) ended->finish();
             ended.reset();
           })
      .def("observe", [](Film& film) {
        film.held->work([&](Simulation& simulation) { film.filming->observe(simulation); });
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
            return scripts_of(py::str(file.string())).front();
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
