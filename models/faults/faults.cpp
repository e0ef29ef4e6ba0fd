#include "models/faults/faults.hpp"

#include "base/diagnostics.hpp"
#include "engine/spec/body_type.hpp"
#include "engine/spec/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::models {
namespace {

using engine::BodyType;
using engine::Impairment;

/// Splits a text at commas and removes the spaces around each word: "ir, sonar" gives "ir" and "sonar".
std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (word.starts_with(' ')) word.remove_prefix(1);
    while (word.ends_with(' ')) word.remove_suffix(1);
    words.push_back(word);
  }
  return words;
}

struct DeadSensors {
  struct Params {
    std::string sensors;

    static constexpr void describe(engine::Description<Params>& d) {
      d.member<&Params::sensors>(
          "sensors", "names of the sensors that fail, separated by commas; empty: all sensors of the robot");
    }
  };

  static Result<Impairment> prepare(const Params& params, const BodyType& type) {
    Impairment impairment;
    std::vector<std::string_view> sensors;  // names of the sensors of the type
    for (const BodyType::Device& device : type.devices)
      if (device.kind->is_sensor()) sensors.push_back(device.name);
    std::vector<std::string_view> wanted = words_of(params.sensors);
    if (wanted.empty()) wanted = sensors;
    if (wanted.empty())
      return Error{fmt::format("this fault needs a sensor, but bodies of type \"{}\" have none", type.name)};
    for (const std::string_view name : wanted) {
      const auto device = std::ranges::find(type.devices, name, &BodyType::Device::name);
      if (device == type.devices.end() || !device->kind->is_sensor())
        return Error{unknown_name(fmt::format("sensor of type \"{}\"", type.name), name, sensors)};
      const auto d = static_cast<std::size_t>(device - type.devices.begin());
      if (d >= engine::k_most_fallible)
        return Error{
            fmt::format("\"{}\" is device {} of type \"{}\" (counted from 1), but faults can only "
                        "concern the first {}: move it up in the list of sensors",
                        name, d + 1, type.name, engine::k_most_fallible)};
      impairment.dead |= std::uint32_t{1} << d;
    }
    return impairment;
  }
};

struct SlowWheels {
  struct Params {
    double factor = 1;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::factor>("factor", above(0), at_most(1), required,
                                "factor by which all velocities of the drive are multiplied");
    }
  };

  static Result<Impairment> prepare(const Params& params, const BodyType& type) {
    if (!type.drive)
      return Error{fmt::format("this fault needs a drive, but bodies of type \"{}\" have none", type.name)};
    return Impairment{.speed = params.factor};
  }
};

struct DropOut {
  struct Params {
    double rate = 0;
    double duration = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::rate>("rate", per_second, above(0), at_most(1e6), required,
                              "mean number of failures per second of a working robot: within t seconds, such "
                              "a robot fails with probability 1 - exp(-rate t)");
      d.member<&Params::duration>("for", seconds, within(0, engine::k_most_seconds),
                                  "duration of a failure, after which the robot works again until its next "
                                  "failure; 0: failures are permanent");
    }
  };

  static Result<Impairment> prepare(const Params& params, const BodyType&) {
    return Impairment{.drops_out = true, .per_s = params.rate, .lasts_s = params.duration};
  }
};

}  // namespace

engine::FaultKind dead_sensors_fault() {
  return engine::make_fault_kind<DeadSensors>("dead_sensors",
                                              "sensors that stop working: they repeat their last readings");
}

engine::FaultKind slow_wheels_fault() {
  return engine::make_fault_kind<SlowWheels>("slow_wheels", "a drive that is slower than commanded");
}

engine::FaultKind drop_out_fault() {
  return engine::make_fault_kind<DropOut>(
      "drop_out",
      "a robot that fails as a whole at random times (its drive, devices and controllers all stop), each "
      "time for a limited time, or once and permanently");
}

}  // namespace troupe::models
