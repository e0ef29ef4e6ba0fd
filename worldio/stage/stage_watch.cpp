#include "worldio/stage/stage_watch.hpp"

#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldType;
using engine::Value;

/// The unit of a number in a `.world` file.
enum class Scale {
  one,
  length,   // in unit_length
  degrees,  // always degrees, not unit_angle
  milliseconds
};

/// A property of a window and the field that stores it. Switches (`show_...`) are not listed, because they
/// have the name of their field.
struct WindowProperty {
  std::string_view stage;
  std::string_view field;
  Scale scale = Scale::one;
};

constexpr WindowProperty k_properties[] = {
    {"size", "size_px"},
    {"center", "center"},
    {"rotate", "rotate", Scale::degrees},
    {"scale", "scale_px_per_m"},
    {"pcam_loc", "camera", Scale::length},
    {"pcam_angle", "camera_angle", Scale::degrees},
    {"pcam_on", "perspective"},
    {"interval", "interval", Scale::milliseconds},
    {"screenshots", "screenshots"},
    {"screenshot_skip", "screenshot_skip"},
    {"follow_model", "follow"},
};

double factor(Scale scale, double length_unit) {
  switch (scale) {
    case Scale::one: break;
    case Scale::length: return length_unit;
    case Scale::degrees: return radians(1);
    case Scale::milliseconds: return 0.001;
  }
  return 1;
}

Value read_value(const StageProperty& property, const Field& field, double to_si, StageValues& values) {
  const auto within = [&](double written) {
    return values.is_within(property, field, written * to_si, written);
  };
  switch (field.type) {
    case FieldType::boolean:
      if (const auto flag = values.flag(property)) return *flag;
      return {};
    case FieldType::integer: {
      const auto number = values.integer(property);
      if (!number || !within(static_cast<double>(*number))) return {};
      return *number;
    }
    case FieldType::text:
      if (const auto text = values.text(property)) return std::string(*text);
      return {};
    case FieldType::numbers: {
      auto numbers =
          values.tuple(property, field.columns, field.columns, field.columns == 2 ? "[a b]" : "[x y z]");
      if (!numbers) return {};
      for (double& number : *numbers) {
        if (!within(number)) return {};
        number *= to_si;
      }
      return *numbers;
    }
    default: break;
  }
  const auto number = values.number(property);
  if (!number || !within(*number)) return {};
  return *number * to_si;
}

}  // namespace

engine::WatchSpec read_stage_watch(const StageDocument& document, StageValues& values) {
  engine::WatchSpec watch;
  watch.clock = values.flag(document.world_property("show_clock"), false);
  if (const StageProperty* property = document.world_property("show_clock_interval")) {
    const auto ticks = values.integer(*property);
    if (ticks && *ticks >= 1 && *ticks <= engine::k_most_clock_ticks)
      watch.clock_ticks = static_cast<std::uint64_t>(*ticks);
    else if (ticks)
      values.may_exceed(values.where(*property),
                        fmt::format("\"show_clock_interval\" must be from 1 to {} ticks, found {}",
                                    engine::k_most_clock_ticks, *ticks),
                        watch.clock ? "" : "\"show_clock\" is 0");
  }
  // Stage reads 0 and below as "as fast as possible".
  if (const StageProperty* property = document.world_property("speedup"))
    watch.rate = std::clamp(values.number(*property).value_or(1), 0.0, engine::k_most_rate);
  watch.paused = values.flag(document.world_property("paused"), false);
  return watch;
}

engine::Record read_stage_window(const StageModel& window, const StageDocument& document,
                                 StageValues& values) {
  const engine::FieldTable& table = window_fields();
  engine::Record record = table.defaults();
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const Field& field = table.fields[i];
    const auto* known = std::ranges::find(k_properties, field.name, &WindowProperty::field);
    const bool is_switch = known == std::end(k_properties);
    const StageProperty* property = window.find(document, is_switch ? field.name : known->stage);
    if (!property) continue;
    Value value =
        read_value(*property, field, is_switch ? 1 : factor(known->scale, values.length_unit()), values);
    if (value.given()) record[i] = std::move(value);
  }
  return record;
}

void write_stage_watch(const engine::WatchSpec& watch, StageText& text) {
  const auto& [clock, clock_ticks, rate, paused] = watch;
  const engine::WatchSpec usual;
  if (clock) text.flag("show_clock", true);
  if (clock_ticks != usual.clock_ticks) text.number("show_clock_interval", static_cast<double>(clock_ticks));
  if (rate != usual.rate) text.number("speedup", rate);
  if (paused) text.flag("paused", true);
}

void write_stage_window(const engine::Record& window, StageText& text) {
  const engine::FieldTable& table = window_fields();
  text.open("window");
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const Field& field = table.fields[i];
    const auto* known = std::ranges::find(k_properties, field.name, &WindowProperty::field);
    const bool is_switch = known == std::end(k_properties);
    const std::string_view key = is_switch ? field.name : known->stage;
    const double to_si = is_switch ? 1 : factor(known->scale, 1);
    const auto written = [to_si](double si) {
      return solved(si, si / to_si, [to_si](double x) { return x * to_si; });
    };
    const Value& value = window[i];
    if (same_bits(value, field.fallback)) continue;
    switch (field.type) {
      case FieldType::boolean: text.flag(key, value.boolean()); break;
      case FieldType::integer: text.number(key, static_cast<double>(value.integer())); break;
      case FieldType::text: text.text(key, value.text()); break;
      case FieldType::numbers: {
        std::vector<double> numbers;
        for (const double x : value.numbers()) numbers.push_back(written(x));
        text.numbers(key, numbers);
        break;
      }
      default: text.number(key, written(value.number()));
    }
  }
  text.close();
}

}  // namespace troupe::worldio
