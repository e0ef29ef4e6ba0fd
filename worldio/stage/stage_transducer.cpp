#include "engine/fields/description.hpp"
#include "worldio/stage/stage_kinds.hpp"
#include "worldio/stage/stage_limits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::worldio {
namespace {

using engine::TransducerParams;

/// Reads the properties of a transducer. Every wrong property is reported.
class TransducerReader {
 public:
  TransducerReader(const StageDocument& document, StageValues& values, const StageModel& sensor)
      : document_(document), values_(values), sensor_(sensor) {}

  std::optional<TransducerParams> read() {
    const bool is_the_ranger = !sensor_.alias.empty();  // a laser or sonar is its own sensor
    if (sensor_.alias == "laser") {                     // defaults of the lasers of older files
      params_.range_max = 8;
      params_.fov = radians(180);
      params_.samples = 180;
    }
    read("apply_range_min", &TransducerReader::read_apply_range_min);  // decides what check() reports
    read("samples", &TransducerReader::read_samples);
    if (!is_the_ranger) {
      read("pose", &TransducerReader::read_pose);
      read("size", &TransducerReader::read_size);
    }
    read("range", &TransducerReader::read_range);
    if (is_the_ranger) {
      read("range_min", &TransducerReader::read_range_min);
      read("range_max", &TransducerReader::read_range_max);
      if (is_right_ &&
          !is_ordered(sensor_.where, fmt::format("\"range_min\", {} m, must be at most \"range_max\", {} m",
                                                 params_.range_min, params_.range_max)))
        return {};
    }
    read("fov", &TransducerReader::read_fov);
    read("noise", &TransducerReader::read_noise);
    read("beam_width", &TransducerReader::read_beam_width);
    if (!is_right_) return {};
    params_.pose.z += size_.z() / 2;  // beams leave from the middle of the transducer's height
    if (!values_.is_in_reach(sensor_.where, params_.pose.z, "the middle of this sensor")) return {};
    return params_;
  }

 private:
  /// Reads a property if the sensor has it. `read_property` returns whether its value is right.
  void read(std::string_view key, bool (TransducerReader::*read_property)(const StageProperty&)) {
    const StageProperty* property = sensor_.find(document_, key);
    if (property && !(this->*read_property)(*property)) is_right_ = false;
  }

  bool read_pose(const StageProperty& property) {
    const auto given = values_.pose_in_device(property);
    params_.pose = given.value_or(params_.pose);
    return given.has_value();
  }

  bool read_size(const StageProperty& property) {
    const auto given = values_.size(property, size_.z());
    size_ = given.value_or(size_);
    return given.has_value();
  }

  bool read_range(const StageProperty& property) {
    const auto given = values_.tuple(property, 2, 2, "[min max]");
    if (!given) return false;
    params_.range_min = (*given)[0] * values_.length_unit();
    params_.range_max = (*given)[1] * values_.length_unit();
    const bool min_is_right = check("range_min", params_.range_min, property);
    const bool max_is_right = check("range_max", params_.range_max, property);
    if (!min_is_right || !max_is_right) return false;
    return is_ordered(values_.where(property),
                      fmt::format("\"range\" needs [min max] with min at most max, found [{} {}]",
                                  (*given)[0], (*given)[1]));
  }

  /// Whether the minimum of the range is at most the maximum, or has no effect. Reports `message` if it is
  /// above the maximum.
  bool is_ordered(Where where, const std::string& message) {
    if (params_.range_min <= params_.range_max) return true;
    return values_.may_exceed(
        where, message, params_.apply_range_min ? "" : "the minimum counts only with \"apply_range_min 1\"");
  }

  bool read_range_min(const StageProperty& property) {
    return read_length("range_min", property, params_.range_min);
  }

  bool read_range_max(const StageProperty& property) {
    return read_length("range_max", property, params_.range_max);
  }

  bool read_length(std::string_view field_name, const StageProperty& property, double& length) {
    const auto given = values_.number(property);
    if (!given) return false;
    length = *given * values_.length_unit();
    return check(field_name, length, property);
  }

  bool read_fov(const StageProperty& property) {
    const auto given = values_.number(property);
    if (!given) return false;
    params_.fov = within_a_turn(*given * values_.angle_unit());
    return check("fov", params_.fov, property);
  }

  bool read_samples(const StageProperty& property) {
    const auto given = values_.integer(property);
    if (!given) return false;
    params_.samples = *given;
    return check("samples", static_cast<double>(params_.samples), property);
  }

  bool read_noise(const StageProperty& property) {
    const auto given = values_.tuple(property, 3, 3, "[variance share angle]");
    if (!given) return false;
    if (std::ranges::any_of(*given, [](double part) { return part < 0; })) {
      values_.error(
          values_.where(property),
          fmt::format("\"noise\" needs values of 0 or above, [variance share angle], found [{} {} {}]",
                      (*given)[0], (*given)[1], (*given)[2]));
      return false;
    }
    // Stage reads the first number as a variance and scales the third by half the angle between beams.
    const double step = params_.fov / static_cast<double>(std::max<std::int64_t>(params_.samples - 1, 1));
    params_.noise_stddev = sqrt((*given)[0] * values_.length_unit());
    params_.noise_proportional = (*given)[1];
    params_.noise_angular = 0.5 * step * (*given)[2] * values_.angle_unit();
    return check("noise_stddev", params_.noise_stddev, property) &&
           check("noise_proportional", params_.noise_proportional, property) &&
           check("noise_angular", params_.noise_angular, property);
  }

  bool read_beam_width(const StageProperty& property) {
    const auto given = values_.number(property);
    if (!given) return false;
    params_.beam_width = *given * values_.angle_unit();
    return check("beam_width", params_.beam_width, property);
  }

  bool read_apply_range_min(const StageProperty& property) {
    const auto given = values_.flag(property);
    params_.apply_range_min = given.value_or(false);
    return given.has_value();
  }

  /// Checks a value, in SI units, against the limits of its field. The error uses the name that the property
  /// has in the file and, for a tuple, says which of its numbers is wrong.
  bool check(std::string_view field_name, double value, const StageProperty& property) {
    const engine::FieldTable& table = engine::described<TransducerParams>();
    const auto at = static_cast<std::size_t>(table.find(field_name));
    const double to_si = values_.unit(table.fields[at].unit);
    const Result<> kept = check_limits(table.fields[at], value, to_si);
    if (kept) return true;
    const std::string_view key = values_.key(property);
    const std::string_view number =
        key == "range"                       ? (field_name == "range_min" ? ": the minimum" : ": the maximum")
        : field_name == "noise_stddev"       ? ": the square root of the first number (variance)"
        : field_name == "noise_proportional" ? ": the second number (share)"
        : field_name == "noise_angular" ? ": the third number (angle), times half the angle between beams,"
                                        : "";
    const std::string message = fmt::format("\"{}\"{} {}, found {}", key, number, kept.error().text,
                                            in_unit(value, table.fields[at], to_si));
    const engine::Record record = engine::to_record(params_);
    const bool has_effect = engine::is_used(table, record, table.fields[at]);
    return values_.may_exceed(values_.where(property), message,
                              has_effect ? "" : engine::unused_reason(table, record, table.fields[at]));
  }

  const StageDocument& document_;
  StageValues& values_;
  const StageModel& sensor_;
  TransducerParams params_;
  Eigen::Vector3d size_{0.02, 0.02, 0.02};
  bool is_right_ = true;  ///< whether all properties that were read are right
};

}  // namespace

std::optional<TransducerParams> StageKinds::transducer(const StageModel& sensor) {
  return TransducerReader(document_, values_, sensor).read();
}

}  // namespace troupe::worldio
