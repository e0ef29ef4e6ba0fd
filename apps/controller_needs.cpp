#include "apps/controller_needs.hpp"

#include "apps/example_params.hpp"
#include "base/diagnostics.hpp"
#include "engine/spec/world_spec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

using engine::ControllerKind;
using engine::DeviceKind;
using engine::FieldTable;
using engine::Record;

constexpr std::string_view k_needs = "needs ";  // begins the errors that say what a controller lacks
constexpr std::string_view k_no_drive = "no drive";

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
      if (auto prepared = prepare_example(device, Example::wide))
        devices_.push_back({device.name, std::move(*prepared)});
    }
  }

  std::size_t devices() const { return devices_.size(); }
  std::string_view name(std::size_t device) const { return devices_[device].kind; }

  /// Returns the devices that the controller uses of those in `given`.
  Result<std::vector<std::size_t>> used(const std::vector<std::size_t>& given) const {
    try {
      const Result<ControllerKind::Prepared> prepared = prepare(given);
      if (!prepared) return prepared.error();
      std::vector<std::size_t> used;
      for (const std::size_t d : prepared->devices) used.push_back(given.at(d));
      return used;
    } catch (...) {
      return Error{};  // of a plug-in, which may throw anything
    }
  }

  /// Returns which drive the controller needs: "no drive", or as in its error for a robot without a drive.
  /// given: the devices that the controller needs. Not for a controller with ControllerKind::needs_drive.
  std::string drive(const std::vector<std::size_t>& given) const {
    if (kind_.needs_drive || !kind_.bind_world) return std::string(k_no_drive);
    engine::WorldSpec world;
    engine::TypeSpec& type = world.types.emplace_back();
    type.name = "robot";
    type.parts.emplace_back();
    try {
      Result<ControllerKind::Prepared> prepared = prepare(given);
      const Result<> bound = prepared ? kind_.bind_world(prepared->data, world, type, 0) : Result<>();
      const std::string error = bound ? "" : bound.error().text;
      // After the comma, the text is about the robot: "needs a drive for the role "robot", but type ...".
      if (error.starts_with("needs a drive"))
        return error.substr(k_needs.size(), error.find(',') - k_needs.size());
    } catch (...) {  // of a plug-in, which may throw anything
    }
    return std::string(k_no_drive);
  }

 private:
  Result<ControllerKind::Prepared> prepare(const std::vector<std::size_t>& given) const {
    std::vector<engine::DeviceInfo> infos;
    for (const std::size_t d : given)
      infos.push_back({devices_[d].kind, devices_[d].kind, devices_[d].prepared});
    std::vector<bool> claimed(infos.size());
    return kind_.prepare(params_, infos, claimed);
  }

  const ControllerKind& kind_;
  Record params_;
  std::deque<Device> devices_;
};

/// Returns the first part of an error, without the details of the robot: "needs a radio".
std::string head_of(const Error& error) { return error.text.substr(0, error.text.find(';')); }

/// What a controller uses.
struct Needs {
  std::string drive{k_no_drive};           ///< of a controller without ControllerKind::needs_drive
  std::vector<std::string> required;       ///< as in the errors of the controller, without "needs "
  std::vector<std::string_view> optional;  ///< kinds of further devices
  bool uses_all = false;                   ///< the controller uses all devices that it is given
  bool is_complete = false;                ///< false: there may be further devices
};

Needs needs_of(const Trial& trial) {
  Needs needs;
  std::vector<std::size_t> given;
  Result<std::vector<std::size_t>> used = trial.used(given);
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
  needs.drive = trial.drive(given);
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
  Needs needs = needs_of(Trial(registry, kind, example_params(params, Example::usual)));
  if (!needs.is_complete) {  // a controller may need names, such as those of models
    Needs named = needs_of(Trial(registry, kind, example_params(params, Example::named)));
    if (named.is_complete) needs = std::move(named);
  }
  std::string text = "needs\n";
  text += fmt::format("  {}\n", kind.needs_drive ? "a drive" : needs.drive);
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
