#include "apps/controller_needs.hpp"

#include "base/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

using engine::ControllerKind;
using engine::DeviceKind;
using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Record;

/// Smallest number of beams, pixels, bytes and so on of the devices with which a controller is tried.
constexpr double k_readings = 16;

/// Which parameters example_of() returns.
enum class Example {
  usual,  ///< the defaults, values for parameters that are required, and one object in each list of objects
  named,  ///< with a name in place of empty texts, too
  wide,   ///< at least k_readings in each number of readings, and the largest field of view, so that most
          ///< controllers can use a device with these parameters
};

/// Returns parameters of a kind.
Record example_of(const FieldTable& table, Example example) {
  const bool is_wide = example == Example::wide;
  Record record = table.defaults();
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const Field& field = table.fields[i];
    engine::Value& value = record[i];
    if (field.optional) continue;
    if (field.record != nullptr) {
      value = std::vector<Record>{example_of(*field.record, example)};
    } else if (field.type == FieldType::integer) {
      const double least = is_wide ? k_readings : 1;
      const auto one = static_cast<std::int64_t>(std::clamp(least, field.min, field.max));
      if (!value.given() || is_wide) value = value.given() ? std::max(value.integer(), one) : one;
    } else if (field.type == FieldType::number) {
      const bool is_view = field.unit == engine::Unit::radians && field.min >= 0 && std::isfinite(field.max);
      if (is_wide && is_view) value = field.max;
      if (!value.given()) value = std::clamp(1.0, field.min, field.max);
    } else if (field.type == FieldType::numbers && !value.given()) {
      value =
          std::vector<double>(std::max<std::size_t>(field.columns, 1), std::clamp(1.0, field.min, field.max));
    } else if (field.type == FieldType::text && !value.given()) {
      value = std::string(field.choices.empty() ? "name" : field.choices.front());
    } else if (field.type == FieldType::text && example == Example::named && value.text().empty()) {
      value = std::string("name");
    }
  }
  return record;
}

/// A device of the robot with which a controller is tried.
struct Device {
  std::string_view kind;
  DeviceKind::Prepared prepared;
};

/// Tries a controller with devices.
class Trial {
 public:
  Trial(const engine::Registry& registry, const ControllerKind& kind, Record params)
      : kind_(kind), params_(std::move(params)) {
    for (const DeviceKind& device : registry.devices) {
      if (device.drives) continue;  // controllers command it as the drive
      try {
        devices_.push_back({device.name, device.prepare(example_of(device.params, Example::wide), {})});
      } catch (const std::exception&) {
        continue;  // no device of this kind can have these parameters
      }
    }
  }

  std::size_t devices() const { return devices_.size(); }
  std::string_view name(std::size_t device) const { return devices_[device].kind; }

  /// Returns the devices that the controller uses of those in `given`.
  Result<std::vector<std::size_t>> used(const std::vector<std::size_t>& given) const {
    std::vector<engine::DeviceInfo> infos;
    for (const std::size_t d : given)
      infos.push_back({devices_[d].kind, devices_[d].kind, devices_[d].prepared});
    std::vector<bool> claimed(infos.size());
    try {
      const Result<ControllerKind::Prepared> prepared = kind_.prepare(params_, infos, claimed);
      if (!prepared) return prepared.error();
      std::vector<std::size_t> used;
      for (const std::size_t d : prepared->devices) used.push_back(given.at(d));
      return used;
    } catch (...) {
      return Error{};  // of a plug-in, which may throw anything
    }
  }

 private:
  const ControllerKind& kind_;
  Record params_;
  std::deque<Device> devices_;
};

/// Returns the first part of an error, without the details of the robot: "needs a radio".
std::string head_of(const Error& error) { return error.text.substr(0, error.text.find(';')); }

/// What a controller uses.
struct Needs {
  std::vector<std::string> required;       ///< as in the errors of the controller, without "needs "
  std::vector<std::string_view> optional;  ///< kinds of further devices
  bool uses_all = false;                   ///< the controller uses all devices that it is given
  bool is_complete = false;                ///< false: there may be further devices
};

Needs needs_of(const Trial& trial) {
  Needs needs;
  std::vector<std::size_t> given;
  Result<std::vector<std::size_t>> used = trial.used(given);
  constexpr std::string_view k_needs = "needs ";
  while (!used) {
    const std::string error = head_of(used.error());
    if (!error.starts_with(k_needs)) return needs;
    needs.required.push_back(error.substr(k_needs.size()));
    // The next device is the one that fulfils this need: with it, the controller lacks nothing or something
    // else.
    bool is_found = false;
    for (std::size_t d = 0; d < trial.devices() && !is_found; ++d) {
      if (std::ranges::count(given, d) > 0) continue;
      given.push_back(d);
      Result<std::vector<std::size_t>> next = trial.used(given);
      is_found = next || head_of(next.error()) != error;
      if (is_found)
        used = std::move(next);
      else
        given.pop_back();
    }
    if (!is_found) return needs;
  }
  for (std::size_t d = 0; d < trial.devices(); ++d) {
    if (std::ranges::count(given, d) > 0) continue;
    given.push_back(d);
    const Result<std::vector<std::size_t>> with = trial.used(given);
    if (with && std::ranges::count(*with, d) > 0) needs.optional.push_back(trial.name(d));
    given.pop_back();
  }
  needs.is_complete = true;
  needs.uses_all = !needs.optional.empty() && needs.optional.size() + given.size() == trial.devices();
  return needs;
}

}  // namespace

std::string needs_text(const engine::Registry& registry, const ControllerKind& kind,
                       const FieldTable& params) {
  Needs needs = needs_of(Trial(registry, kind, example_of(params, Example::usual)));
  if (!needs.is_complete) {  // a controller may need names, such as those of models
    Needs named = needs_of(Trial(registry, kind, example_of(params, Example::named)));
    if (named.is_complete) needs = std::move(named);
  }
  std::string text = "needs\n";
  text += kind.needs_drive ? "  a drive\n" : "  no drive\n";
  for (const std::string& need : needs.required) text += fmt::format("  {}\n", need);
  if (!needs.is_complete) text += "  devices that depend on its parameters\n";
  if (needs.uses_all)
    text += fmt::format("  uses all devices of the robot; there may be at most {}\n",
                        engine::k_most_devices_read);
  else if (!needs.optional.empty())
    text += fmt::format("  uses, if the robot has them: {}\n", comma_list(needs.optional));
  if (!kind.brings.empty())
    text += fmt::format("  in a .world file, a model without {} gets one\n", comma_list(kind.brings));
  if (kind.switches) text += "  may switch devices off and on\n";
  text += kind.is_collective ? "  one call decides for all robots of a type\n"
                             : "  one call decides for one robot\n";
  return text + "\n";
}

}  // namespace troupe::apps
