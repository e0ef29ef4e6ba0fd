#include "worldio/stage/stage_device_writer.hpp"

#include "engine/kinds/sensor_params.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/stage/stage_devices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::DeviceKind;
using engine::DeviceSpec;
using engine::FieldType;
using engine::Record;
using engine::Value;

void write_parameters(const DeviceSpec& device, const DeviceKind& kind, StageText& text) {
  const Record defaults = kind.params.defaults();
  for (const StageParameter& parameter : stage_parameters()) {
    if (parameter.model != device.kind || parameter.column > 0) continue;
    const double to_si = parameter.unit == StageUnit::degrees        ? radians(1)
                         : parameter.unit == StageUnit::milliseconds ? 1e-3
                                                                     : 1.0;  // metres and radians
    const auto written = [to_si](double si) {
      return solved(si, si / to_si, [to_si](double x) { return x * to_si; });
    };
    const auto as_number = [&](const Value& value) {
      const auto* whole = std::get_if<std::int64_t>(&value.v);
      return whole ? static_cast<double>(*whole) : written(value.number());
    };
    const auto at = static_cast<std::size_t>(kind.params.find(parameter.field));
    const Value& value = device.params[at];
    if (parameter.column == 0) {  // the first number of a tuple [a b]; the second is another field
      const auto other = std::ranges::find_if(stage_parameters(), [&](const StageParameter& one) {
        return one.model == parameter.model && one.property == parameter.property && one.column == 1;
      });
      text.numbers(parameter.property,
                   std::array{as_number(value), as_number(get(kind.params, device.params, other->field))});
    } else if (!same_bits(value, defaults[at])) {
      switch (kind.params.fields[at].type) {
        case FieldType::boolean: text.flag(parameter.property, value.boolean()); break;
        case FieldType::text: text.text(parameter.property, value.text()); break;
        case FieldType::numbers: text.numbers(parameter.property, value.numbers()); break;
        default: text.number(parameter.property, as_number(value));
      }
    }
  }
}

void write_ranger(const DeviceSpec& device, StageText& text) {
  const auto ranger = engine::from_record<engine::RangerParams>(device.params);
  if (ranger.intensity) text.flag("intensity", true);
  for (const engine::TransducerParams& transducer : ranger.transducers) {
    const Pose& pose = transducer.pose;
    constexpr double k_middle = 0.02 / 2;  // m: height of the beams in a transducer of Stage's default size
    const double z = solved(pose.z, pose.z - k_middle, [](double x) { return x + k_middle; });
    text.open("sensor");
    text.pose("pose", {pose.x, pose.y, z, pose.heading});
    text.numbers("range", std::array{transducer.range_min, transducer.range_max});
    text.number("fov", transducer.fov);
    text.number("samples", static_cast<double>(transducer.samples));
    const double stddev = transducer.noise_stddev;
    const double angular = transducer.noise_angular;
    if (stddev > 0 || angular > 0 || transducer.noise_proportional > 0) {
      const double step =
          transducer.fov / static_cast<double>(std::max<std::int64_t>(transducer.samples - 1, 1));
      const double variance = solved(stddev, stddev * stddev, [](double x) { return sqrt(x); });
      const double share = angular == 0 || step == 0 ? 0
                                                     : solved(angular, angular / (0.5 * step),
                                                              [step](double x) { return 0.5 * step * x; });
      text.numbers("noise", std::array{variance, transducer.noise_proportional, share});
    }
    if (transducer.beam_width > 0) text.number("beam_width", transducer.beam_width);
    if (transducer.apply_range_min) text.flag("apply_range_min", true);
    text.close();
  }
}

void write_bumpers(const DeviceSpec& device, StageText& text) {
  const auto params = engine::from_record<engine::BumperParams>(device.params);
  if (params.bumpers.empty()) return;
  text.number("bcount", static_cast<double>(params.bumpers.size()));
  for (std::size_t k = 0; k < params.bumpers.size(); ++k) {
    const auto& [pose, length] = params.bumpers[k];
    text.numbers(fmt::format("bpose[{}]", k), std::array{pose.x, pose.y, pose.z, pose.heading});
    text.number(fmt::format("blength[{}]", k), length);
  }
  if (params.crashes) text.flag("crashes", true);
}

void write_blob_colors(const DeviceSpec& device, const DeviceKind& kind, StageText& text) {
  const std::vector<double>& parts = get(kind.params, device.params, "colors").numbers();
  std::vector<std::string> names;
  for (std::size_t i = 0; i + 2 < parts.size(); i += 3) {
    const JsonNode node = color_node({static_cast<float>(parts[i]), static_cast<float>(parts[i + 1]),
                                      static_cast<float>(parts[i + 2]), 1});
    names.push_back(node.text() ? *node.text() : "red");  // the round trip reports a colour without a name
  }
  if (names.empty()) return;
  text.number("colors_count", static_cast<double>(names.size()));
  text.texts("colors", names);
}

void write_radio(const DeviceSpec& device, const DeviceKind& kind, StageText& text) {
  const std::string& law = get(kind.params, device.params, "law").text();
  text.text("model", std::ranges::find(stage_radio_laws(), law, &StageRadioLaw::law)->model);
  text.text("walls", get(kind.params, device.params, "walls").text());
  text.number("range", get(kind.params, device.params, "range").number());
}

/// Returns a value as an argument of `ctrl`. Empty if the syntax of `ctrl` cannot express the value.
std::optional<std::string> argument(const Value& value) {
  if (const bool* x = std::get_if<bool>(&value.v)) return *x ? "1" : "0";
  if (const auto* x = std::get_if<std::int64_t>(&value.v)) return fmt::format("{}", *x);
  if (const auto* x = std::get_if<double>(&value.v)) return fmt::format("{}", *x);
  if (const auto* x = std::get_if<std::string>(&value.v))
    return x->find_first_of(" \t") == x->npos ? std::optional(*x) : std::nullopt;
  if (const auto* x = std::get_if<std::vector<double>>(&value.v); x && !x->empty()) {
    std::string numbers;
    for (const double number : *x) numbers += fmt::format("{}{}", numbers.empty() ? "" : ",", number);
    return numbers;
  }
  return std::nullopt;
}

}  // namespace

double stage_milliseconds(double seconds) {
  return solved(seconds, seconds * 1000, [](double ms) { return ms / 1000; });
}

void write_stage_device(const DeviceSpec& device, const DeviceKind& kind, StageText& text) {
  if (device.active) text.flag("alwayson", true);
  text.number("update_interval", stage_milliseconds(device.period_s));
  if (device.kind == "ranger") return write_ranger(device, text);
  write_parameters(device, kind, text);
  if (device.kind == "bumper") write_bumpers(device, text);
  if (device.kind == "blobfinder") write_blob_colors(device, kind, text);
  if (device.kind == "radio") write_radio(device, kind, text);
  if (device.kind != "gripper") return;
  text.numbers("paddle_size", get(kind.params, device.params, "paddle_size").numbers());
  text.texts("paddle_state", std::array{get(kind.params, device.params, "paddles").text(),
                                        get(kind.params, device.params, "lift").text()});
}

namespace {

/// Writes the kind of a drive, its period, its limits and its first velocity.
void write_limits(const engine::DriveSpec& drive, const engine::DriveKind& kind, StageText& text) {
  const auto value = [&](std::string_view name, double fallback) {
    const int at = kind.params.find(name);
    return at < 0 ? fallback : drive.params[static_cast<std::size_t>(at)].number();
  };
  text.text("drive", drive.kind);
  text.number("update_interval", stage_milliseconds(drive.period_s));
  const double quarter_turn = radians(90);
  text.numbers("velocity_bounds",
               std::array{value("velocity_min_x", -1), value("velocity_max_x", 1),
                          value("velocity_min_y", -1), value("velocity_max_y", 1), -1.0, 1.0,
                          value("turn_min", -quarter_turn), value("turn_max", quarter_turn)});
  text.numbers("acceleration_bounds",
               std::array{value("acceleration_min_x", -1), value("acceleration_max_x", 1),
                          value("acceleration_min_y", -1), value("acceleration_max_y", 1), -1.0, 1.0,
                          value("turn_acceleration_min", -quarter_turn),
                          value("turn_acceleration_max", quarter_turn)});
  if (kind.params.find("wheelbase") >= 0) text.number("wheelbase", value("wheelbase", 1));
  const std::array start{value("start_x", 0), value("start_y", 0), 0.0, value("start_turn", 0)};
  if (start != std::array{0.0, 0.0, 0.0, 0.0}) text.numbers("velocity", start);
  const std::array goal{value("goal_speed_max", 0.4), value("goal_turn_max", 1)};
  if (goal != std::array{0.4, 1.0}) text.numbers("goal_bounds", goal);
}

}  // namespace

void write_stage_drive(const engine::DriveSpec& drive, const engine::DriveKind& kind, StageText& text) {
  write_limits(drive, kind, text);
  if (kind.params.find("localization") < 0) return;
  const std::string& localization = get(kind.params, drive.params, "localization").text();
  text.text("localization", localization);
  text.text("odom_heading", get(kind.params, drive.params, "odom_heading").text());
  const std::vector<double>& origin = get(kind.params, drive.params, "localization_origin").numbers();
  if (origin.size() == 2) {
    text.numbers("localization_origin",
                 std::array{origin[0], origin[1], 0.0,
                            get(kind.params, drive.params, "localization_origin_heading").number()});
    if (localization == "gps") text.flag("gps_origin", true);
  }
  const std::vector<double>& error = get(kind.params, drive.params, "odom_error").numbers();
  if (error.size() == 3) text.numbers("odom_error", std::array{error[0], error[1], 0.0, error[2]});
}

void write_stage_wheels(const DeviceSpec& wheels, double period_s, const engine::Registry& registry,
                        StageText& text) {
  const DeviceKind* own = registry.device(wheels.kind);
  const engine::DriveKind* kind =
      own ? registry.drive(get(own->params, wheels.params, "drive").text()) : nullptr;
  if (!kind) return;
  engine::DriveSpec drive{.kind = std::string(kind->name), .params = kind->params.defaults()};
  drive.period_s = period_s;
  for (std::size_t f = 0; f < kind->params.fields.size(); ++f)
    if (const int at = own->params.find(kind->params.fields[f].name); at >= 0)
      drive.params[f] = wheels.params[static_cast<std::size_t>(at)];
  write_limits(drive, *kind, text);  // such a drive has no odometry
}

Result<std::string> stage_call(const engine::ControllerSpec& controller, const engine::ControllerKind& kind) {
  std::string call = controller.kind;
  const Record defaults = kind.params.defaults();
  for (std::size_t i = 0; i < defaults.size(); ++i) {
    if (same_bits(controller.params[i], defaults[i])) continue;
    if (const auto text = argument(controller.params[i]))
      call += fmt::format(" {}={}", kind.params.fields[i].name, *text);  // values are in SI units
    else if (!defaults[i].given())
      return Error{fmt::format("the value of {}", quoted_keys(kind.params.fields[i]))};
  }
  return call;
}

}  // namespace troupe::worldio
