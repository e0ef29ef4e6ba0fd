#pragma once

#include "engine/kinds/controller.hpp"
#include "python/bindings.hpp"
#include "python/columns.hpp"

#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::python {

/// A controller in Python. The memory of its robots is owned by the engine.
struct PythonController {
  std::string name, text, file;
  py::object decide;                             ///< a bound method: decide(robots)
  py::dtype memory;                              ///< structured type of the memory of one robot
  std::string start;                             ///< initial bytes of the memory of one robot
  std::optional<std::vector<std::string>> uses;  ///< names or kinds of the devices; not set: all
  std::vector<std::string> params;               ///< names of the parameters
};

/// A device that a controller uses. Its index in PreparedController::devices is also its index in the arrays
/// of engine::DecideBatch.
struct UsedDevice {
  std::string name;
  std::vector<engine::StateField> readings, command;
  std::vector<double> bearings;  ///< of the beams, rad, frame of the ranger; empty for other devices
};

/// The content of engine::ControllerKind::Prepared::data for a controller in Python.
struct PreparedController {
  const PythonController* controller;
  std::vector<UsedDevice> devices;
  engine::Record params;  ///< a value for each of PythonController::params
};

/// The robots of a call of decide(). The object can be used only during this call.
class RobotBatch {
 public:
  RobotBatch(const PreparedController& prepared, const engine::DecideBatch& batch)
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
  const engine::DecideBatch& batch() const {
    if (batch_ == nullptr)
      throw std::logic_error(
          "the argument `robots` of decide() can be used only during the call of decide()");
    return *batch_;
  }
  py::array memory() const {
    if (prepared().controller->start.empty() && memory_.size() == 0)
      throw py::attribute_error("the controller has no memory: declare its fields in `memory`");
    return memory_;
  }
  /// A dict that cannot be changed: a change would not be part of the state.
  py::object params() const;
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
  py::array_t<bool> stalled() const {
    py::array_t<bool> out(size());
    for (py::ssize_t i = 0; i < size(); ++i) out.mutable_at(i) = batch().stalled(static_cast<std::size_t>(i));
    return out;
  }
  py::array_t<std::int64_t> blocked_by() const;
  py::array readings(const std::string& field, const std::string& device) const;
  py::array ranges(const std::string& sensor) const;
  py::array_t<double> bearings(const std::string& sensor) const;
  py::dict commands(const std::string& device) const;
  void command(const std::string& device, const Where& where, const py::kwargs& values) const;
  void say(const py::object& message, const std::string& device, const Where& where) const {
    const std::string radio = radio_named(device);
    const std::size_t d = device_named(radio, true);
    const py::dict values = message_command(devices()[d].command, radio, message, size());
    command(radio, where, py::reinterpret_borrow<py::kwargs>(values));
  }
  py::tuple heard(const py::object& type, const std::string& device) const {
    const std::string radio = radio_named(device);
    return messages_of(type, radio, readings("count", radio), readings("length", radio),
                       readings(k_payload, radio));
  }
  template <engine::ControlMode k_mode>
  void drive(const py::object& x, const py::object& turn, const py::object& y, const Where& where) const;
  void go_to(const py::object& x, const py::object& y, const py::object& heading, const Where& where) const {
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
  std::string radio_named(const std::string& name) const;
  const PreparedController& prepared() const {
    batch();  // throws after the call of decide(), when `prepared_` may no longer exist
    return prepared_;
  }
  const std::vector<UsedDevice>& devices() const { return prepared().devices; }

  const PreparedController& prepared_;
  const engine::DecideBatch* batch_;
  py::array memory_;             // a row per robot
  std::vector<Random> randoms_;  // a stream per robot, made by the first draw
};

}  // namespace troupe::python
