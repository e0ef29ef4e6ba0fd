// What Stage says of sensors whose properties are more than parameters as they stand.

#include "worldio/colors.hpp"
#include "worldio/stage_kinds.hpp"

#include <fmt/format.h>

namespace troupe::worldio {

using engine::Record;

/// `colors` are names, of which the first `colors_count` filter; none do where that is not given.
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
                  fmt::format("\"colors_count\" must be from 0 to {}, as many as there "
                              "are \"colors\"; here is {}",
                              given.size(), *used));
    return false;
  }
  std::vector<double> parts;
  for (const std::string_view name : std::span(given).first(static_cast<std::size_t>(*used))) {
    const auto color = color_by_name(name);
    if (!color) {
      values_.error(values_.where(*names), fmt::format("unknown colour \"{}\"; colours have X11 names{}",
                                                       name, did_you_mean(name, color_names())));
      return false;
    }
    parts.insert(parts.end(), {color->r, color->g, color->b});
  }
  spec.params[static_cast<std::size_t>(kind.params.find("colors"))] = std::move(parts);
  return true;
}

bool StageKinds::add_bumpers(const StageModel& model, const engine::DeviceKind& kind,
                             engine::DeviceSpec& spec) {
  constexpr std::int64_t k_most = 1000;
  const StageProperty* count_property = model.find(document_, "bcount");
  if (count_property == nullptr) {
    values_.warning_once(model.where, "a bumper without \"bcount\" feels nothing");
    spec.params[0] = std::vector<Record>();
    return true;
  }
  const auto count = values_.integer(*count_property);
  if (!count) return false;
  if (*count < 1 || *count > k_most) {
    values_.error(values_.where(*count_property),
                  fmt::format("\"bcount\" must be from 1 to {}; here is {}", k_most, *count));
    return false;
  }
  const engine::FieldTable& table = *kind.params.fields[0].record;
  const StageProperty* common = model.find(document_, "blength");
  std::vector<Record> records;
  for (std::int64_t k = 0; k < *count; ++k) {
    Record pose = engine::pose_fields().defaults();
    if (const StageProperty* property = model.find(document_, fmt::format("bpose[{}]", k))) {
      const auto given = values_.pose(*property);
      if (!given) return false;
      pose = {given->x, given->y, given->z, given->heading};
    }
    const StageProperty* own = model.find(document_, fmt::format("blength[{}]", k));
    const StageProperty* length = own != nullptr ? own : common;
    if (length == nullptr) {
      values_.error(model.where,
                    fmt::format("bumper {} has no length: give \"blength\" or \"blength[{}]\"", k, k));
      return false;
    }
    const auto value_of_length = value(*length, table.fields[1], values_.length_unit(), -1);
    if (!value_of_length) return false;
    records.push_back({std::vector<Record>{std::move(pose)}, *value_of_length});
  }
  spec.params[0] = std::move(records);
  return true;
}

}  // namespace troupe::worldio
