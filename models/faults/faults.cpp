#include "models/faults/faults.hpp"

#include "base/diagnostics.hpp"
#include "engine/body_type.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::models {
namespace {

using engine::Ailment;
using engine::BodyType;
using engine::FieldType;
using engine::Record;
using engine::Unit;

/// "ir, sonar" -> ir, sonar.
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

Result<Ailment> dead_sensors(const Record& params, const BodyType& type) {
  Ailment ailment;
  std::vector<std::string_view> sensors;  // of the type
  for (const BodyType::Device& device : type.devices)
    if (device.kind->is_sensor()) sensors.push_back(device.name);
  std::vector<std::string_view> wanted = words_of(params[0].text());
  if (wanted.empty()) wanted = sensors;
  if (wanted.empty()) return Error{fmt::format("bodies of type \"{}\" have no sensor", type.name)};
  for (const std::string_view name : wanted) {
    const auto device = std::ranges::find(type.devices, name, &BodyType::Device::name);
    if (device == type.devices.end() || !device->kind->is_sensor())
      return Error{unknown_name(fmt::format("sensor of type \"{}\"", type.name), name, sensors)};
    const auto d = static_cast<std::size_t>(device - type.devices.begin());
    if (d >= engine::k_most_fallible)
      return Error{fmt::format("\"{}\" is device {} of type \"{}\", and the first {} can fail", name, d + 1,
                               type.name, engine::k_most_fallible)};
    ailment.dead |= std::uint32_t{1} << d;
  }
  return ailment;
}

}  // namespace

engine::FaultKind dead_sensors_fault() {
  engine::FaultKind kind{.name = "dead_sensors", .text = "sensors that keep the reading they had"};
  kind.params = {{{.name = "sensors",
                   .type = FieldType::text,
                   .fallback = "",
                   .text = "their names, with commas between them; empty: all that the robot has"}}};
  kind.prepare = dead_sensors;
  return kind;
}

engine::FaultKind slow_wheels_fault() {
  engine::FaultKind kind{.name = "slow_wheels", .text = "a drive that gives less than it is asked for"};
  kind.params = {{{.name = "factor",
                   .min = 0,
                   .max = 1,
                   .text = "what its speeds are multiplied by",
                   .above_min = true}}};
  kind.prepare = [](const Record& params, const BodyType& type) -> Result<Ailment> {
    if (!type.drive) return Error{fmt::format("bodies of type \"{}\" have no drive", type.name)};
    return Ailment{.speed = params[0].number()};
  };
  return kind;
}

engine::FaultKind drop_out_fault() {
  engine::FaultKind kind{.name = "drop_out", .text = "a robot that stops with all it has"};
  kind.params = {{{.name = "rate",
                   .unit = Unit::per_second,
                   .min = 0,
                   .max = 1e6,
                   .text = "how often it happens to one robot, in the mean; the probability that it has "
                           "happened within t is 1 - exp(-rate t)",
                   .above_min = true},
                  {.name = "for",
                   .unit = Unit::seconds,
                   .fallback = 0.0,
                   .min = 0,
                   .max = 1e9,
                   .text = "how long it is out; then it works again, until the next time; 0: for good"}}};
  kind.prepare = [](const Record& params, const BodyType&) -> Result<Ailment> {
    return Ailment{.drops_out = true, .per_s = params[0].number(), .lasts_s = params[1].number()};
  };
  return kind;
}

}  // namespace troupe::models
