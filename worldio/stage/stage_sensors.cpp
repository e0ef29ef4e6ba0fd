// Reads the properties of sensors that do not map one to one to parameters of a device.

#include "engine/kinds/sensor_params.hpp"
#include "worldio/colors.hpp"
#include "worldio/stage/stage_devices.hpp"
#include "worldio/stage/stage_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::worldio {
namespace {

/// Warns of properties of bumpers that do not exist. Bumpers are numbered from 0 to count - 1.
void warn_of_missing_bumpers(const StageDocument& document, const StageEntity& layer, std::int64_t count,
                             StageValues& values) {
  for (const StageProperty& property : document.properties(layer)) {
    const std::string_view key = document.key(property);
    auto number = index_in(key, "bpose");
    if (!number) number = index_in(key, "blength");
    if (number && (*number < 0 || *number >= count))
      values.warning(
          values.where(property),
          fmt::format("\"{}\" is ignored: \"bcount\" is {}, and bumpers are numbered from 0", key, count));
  }
}

}  // namespace

/// Reads the colours that a blob finder reports: the first `colors_count` names of `colors`. If one of the
/// two properties is missing, the blob finder reports every colour.
bool StageKinds::add_blob_colors(const StageModel& model, const engine::DeviceKind& kind,
                                 engine::DeviceSpec& spec) {
  const StageProperty* names = model.find(document_, "colors");
  const StageProperty* count = model.find(document_, "colors_count");
  if (names == nullptr || count == nullptr) return true;
  const auto used = values_.integer(*count);
  if (!used) return false;
  const std::vector<std::string_view> given = values_.texts(*names);
  if (*used < 0 || static_cast<std::uint64_t>(*used) > given.size()) {
    values_.error(values_.where(*count),
                  fmt::format("\"colors_count\" must be from 0 to {}, the number of \"colors\", found {}",
                              given.size(), *used));
    return false;
  }
  std::vector<double> parts;
  for (const std::string_view name : std::span(given).first(static_cast<std::size_t>(*used))) {
    const auto color = color_by_name(name);
    if (!color) {
      values_.error(values_.where(*names), fmt::format("unknown colour \"{}\"; colours are X11 names{}", name,
                                                       did_you_mean(name, color_names())));
      return false;
    }
    parts.insert(parts.end(), {color->r, color->g, color->b});
  }
  get(kind.params, spec.params, "colors") = std::move(parts);
  return true;
}

bool StageKinds::add_bumpers(const StageModel& model, engine::DeviceSpec& spec) {
  constexpr std::int64_t k_most = 1000;
  engine::BumperParams params;
  const StageProperty* count_property = model.find(document_, "bcount");
  if (count_property == nullptr) {
    values_.warning_once(
        model.where, "a bumper without \"bcount\", the number of bumpers, senses nothing: give \"bcount\"");
    spec.params = engine::to_record(params);
    return true;
  }
  const auto count = values_.integer(*count_property);
  if (!count) return false;
  if (*count < 1 || *count > k_most) {
    values_.error(values_.where(*count_property),
                  fmt::format("\"bcount\" must be from 1 to {}, found {}", k_most, *count));
    return false;
  }
  if (const StageProperty* property = model.find(document_, "crashes")) {
    const auto crashes = values_.flag(*property);
    if (!crashes) return false;
    params.crashes = *crashes;
  }
  for (const StageEntity* layer : model.layers) warn_of_missing_bumpers(document_, *layer, *count, values_);
  const engine::Field& length_field = engine::described<engine::BumperStripParams>().at("length");
  const StageProperty* common = model.find(document_, "blength");
  for (std::int64_t k = 0; k < *count; ++k) {
    engine::BumperStripParams strip;
    if (const StageProperty* property = model.find(document_, fmt::format("bpose[{}]", k))) {
      const auto given = values_.pose_in_device(*property);
      if (!given) return false;
      strip.pose = *given;
    } else if (*count > 1) {
      values_.warning_once(model.where,
                           fmt::format("bumper {} (counted from 0) has no \"bpose[{}]\": its pose is that of "
                                       "the bumper model",
                                       k, k));
    }
    const StageProperty* own = model.find(document_, fmt::format("blength[{}]", k));
    const StageProperty* length = own != nullptr ? own : common;
    if (length == nullptr) {
      values_.error(model.where, fmt::format("bumper {} (counted from 0) has no length: give \"blength\", "
                                             "for all bumpers, or \"blength[{}]\"",
                                             k, k));
      return false;
    }
    const auto given = value(*length, length_field, values_.length_unit(), -1);
    if (!given) return false;
    strip.length = given->number();
    params.bumpers.push_back(strip);
  }
  spec.params = engine::to_record(params);
  return true;
}

/// Reads the propagation law of a radio from the property `model`. The law also determines the defaults of
/// `walls` and `range`, which are read afterwards.
bool StageKinds::add_radio_law(const StageModel& model, const engine::DeviceKind& kind,
                               engine::DeviceSpec& spec) {
  const auto index = [&](std::string_view name) { return static_cast<std::size_t>(kind.params.find(name)); };
  const StageRadioLaw* law = &stage_radio_laws().front();
  if (const StageProperty* property = model.find(document_, "model")) {
    const auto given = values_.text(*property);
    if (!given) return false;
    const auto found = std::ranges::find(stage_radio_laws(), *given, &StageRadioLaw::model);
    if (found == stage_radio_laws().end()) {
      std::vector<std::string_view> known;
      for (const StageRadioLaw& one : stage_radio_laws()) known.push_back(one.model);
      values_.error(values_.where(*property),
                    fmt::format("\"model\" must be one of {}{}, found \"{}\"", comma_list(known),
                                did_you_mean(*given, known), *given));
      return false;
    }
    law = &*found;
  }
  spec.params[index("law")] = std::string(law->law);
  spec.params[index("walls")] = std::string(law->walls);
  if (law->law != "disc") spec.params[index("range")] = k_stage_radio_range;
  const auto read = [&](std::string_view key, double to_si) {
    const StageProperty* property = model.find(document_, key);
    if (property == nullptr) return true;
    auto given = value(*property, kind.params.fields[index(key)], to_si, -1);
    if (given) spec.params[index(key)] = std::move(*given);
    return given.has_value();
  };
  const bool range_is_right = read("range", values_.length_unit());
  const bool walls_are_right = read("walls", 1);
  return range_is_right && walls_are_right;
}

}  // namespace troupe::worldio
