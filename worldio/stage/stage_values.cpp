#include "worldio/stage/stage_values.hpp"

#include "base/limits.hpp"
#include "engine/spec/names.hpp"
#include "worldio/colors.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/stage/stage_limits.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace troupe::worldio {

bool StageValues::first_time(Where where, const std::string& message) {
  return reported_.emplace(where.file, where.line, message).second;
}

void StageValues::error(Where where, std::string message) {
  if (first_time(where, message)) diagnostics_.error(where, std::move(message));
}

void StageValues::warning(Where where, std::string message) {
  if (first_time(where, message)) diagnostics_.warning(where, std::move(message));
}

void StageValues::warning_once(Where where, std::string message) {
  if (first_time(where, message)) diagnostics_.warning_once(where, std::move(message));
}

void StageValues::explain(Where where, std::string message) {
  if (first_time(where, message)) diagnostics_.explain(where, std::move(message));
}

std::string StageValues::place(Where where, Where from) const {
  if (where.file == from.file) return fmt::format("line {}", where.line);
  return fmt::format("{}:{}", diagnostics_.files()->name(where.file), where.line);
}

std::optional<std::string_view> StageValues::text(const StageProperty& property) {
  if (property.tuple) {
    error(where(property), fmt::format("\"{}\" needs one value, not a tuple", key(property)));
    return {};
  }
  return document_.value(property, 0).text;
}

std::optional<std::string_view> StageValues::name(const StageProperty& property) {
  const auto given = text(property);
  if (given && given->size() > engine::k_most_name_bytes) {
    error(where(property), fmt::format("the name has {} bytes, but a name has at most {}", given->size(),
                                       engine::k_most_name_bytes));
    return {};
  }
  if (!given || (!given->empty() && *given != "/")) return given;
  warning_once(where(property), "\"name\" is empty or only a /; a generated name is used instead");
  return {};
}

std::vector<std::string_view> StageValues::texts(const StageProperty& property) {
  std::vector<std::string_view> out;
  for (std::uint32_t i = 0; i < property.count; ++i) out.push_back(document_.value(property, i).text);
  return out;
}

std::optional<double> StageValues::number(const StageProperty& property, const StageToken& token) {
  std::string_view text = token.text;
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, code] = std::from_chars(text.data(), end, value, std::chars_format::fixed);
  if (code == std::errc() && rest == end && std::isfinite(value)) {
    if (std::abs(value) <= k_largest_number) return value;
    error(where(property), fmt::format("\"{}\": {} is out of range; numbers must be from -2^53 to 2^53",
                                       key(property), token.text));
    return {};
  }
  error(where(property),
        fmt::format("\"{}\" needs a number such as 2, -0.5 or .25, found \"{}\"", key(property), token.text));
  return {};
}

std::optional<double> StageValues::number(const StageProperty& property) {
  if (!text(property)) return {};
  return number(property, document_.value(property, 0));
}

std::optional<std::int64_t> StageValues::integer(const StageProperty& property) {
  const std::optional<double> value = number(property);
  if (!value) return {};
  if (*value == std::floor(*value)) return static_cast<std::int64_t>(*value);
  error(where(property), fmt::format("\"{}\" needs a whole number, found {}", key(property), *value));
  return {};
}

std::optional<bool> StageValues::flag(const StageProperty& property) {
  const std::optional<std::int64_t> value = integer(property);
  if (!value) return {};
  return *value != 0;
}

bool StageValues::flag(const StageProperty* property, bool otherwise) {
  return property ? flag(*property).value_or(otherwise) : otherwise;
}

std::optional<std::vector<double>> StageValues::tuple(const StageProperty& property, std::size_t least,
                                                      std::size_t most, std::string_view layout) {
  if (!property.tuple) {
    error(where(property), fmt::format("\"{}\" needs a tuple {}, found {}", key(property), layout,
                                       document_.value(property, 0).text));
    return {};
  }
  if (property.count < least) {
    error(where(property),
          fmt::format("\"{}\" needs {} values {}, found {}", key(property), most, layout, property.count));
    return {};
  }
  if (property.count > most)
    warning(where(property),
            fmt::format("\"{}\" takes {} values {}, found {}; the further values are ignored", key(property),
                        most, layout, property.count));
  std::vector<double> out;
  for (std::uint32_t i = 0; i < std::min<std::size_t>(property.count, most); ++i) {
    const std::optional<double> value = number(property, document_.value(property, i));
    if (!value) return {};
    out.push_back(*value);
  }
  return out;
}

std::optional<Pose> StageValues::pose(const StageProperty& property) { return pose(property, true); }

std::optional<Pose> StageValues::pose_in_device(const StageProperty& property) {
  return pose(property, wraps_headings_);
}

std::optional<Pose> StageValues::pose(const StageProperty& property, bool is_wrapped) {
  const auto v = tuple(property, 3, 4, "[x y z heading]");
  if (!v) return {};
  if (v->size() == 3)
    explain(where(property),
            fmt::format("old syntax: the three values of \"{}\" are read as [x y heading]; write "
                        "[x y z heading]",
                        key(property)));
  const double z = v->size() == 4 ? (*v)[2] : 0;
  for (const double part : {(*v)[0], (*v)[1], z})
    if (std::abs(part) * length_ > k_world_reach_m) {
      error(where(property),
            fmt::format("\"{}\" is outside the world, which reaches {} km from its origin: found {} m",
                        key(property), k_world_reach_m / 1000, part * length_));
      return {};
    }
  const double heading = v->back() * angle_;
  return Pose{(*v)[0] * length_, (*v)[1] * length_, z * length_, is_wrapped ? wrap_angle(heading) : heading};
}

std::optional<Eigen::Vector3d> StageValues::size(const StageProperty& property, double default_height) {
  const auto v = tuple(property, 2, 3, "[x y z]");
  if (!v) return {};
  if (v->size() == 2)
    explain(
        where(property),
        fmt::format("old syntax: the two values of \"{}\" are read as [x y], with a height of {} m; write "
                    "[x y z]",
                    key(property), default_height));
  const engine::Field& limits = document_table<PartDocument>().find("size")->field;
  for (const double extent : *v) {
    if (extent > 0 && !is_within(property, limits, extent * length_, extent)) return {};
    if (extent < 0) {
      error(where(property),
            fmt::format("\"{}\" must be at least 0 in every direction, found {}", key(property), extent));
      return {};
    }
  }
  return Eigen::Vector3d((*v)[0] * length_, (*v)[1] * length_,
                         v->size() == 3 ? (*v)[2] * length_ : default_height);
}

bool StageValues::is_in_reach(Where where, double z_m, std::string_view what) {
  if (std::abs(z_m) <= k_world_reach_m) return true;
  error(where, fmt::format("{} is at a height of {} m, but coordinates must be from -{} to {} km", what, z_m,
                           k_world_reach_m / 1000, k_world_reach_m / 1000));
  return false;
}

bool StageValues::is_within(const StageProperty& property, const engine::Field& field, double si,
                            double written, const std::string& unused) {
  const double to_si = written == 0 ? unit(field.unit) : si / written;
  const Result<> kept = check_limits(field, si, to_si);
  if (kept) return true;
  return may_exceed(where(property),
                    fmt::format("\"{}\" {}, found {}", key(property), kept.error().text, written), unused);
}

bool StageValues::may_exceed(Where where, std::string message, const std::string& unused) {
  if (unused.empty())
    error(where, std::move(message));
  else
    warning_once(where, fmt::format("{}; it has no effect, because {}", message, unused));
  return !unused.empty();
}

double StageValues::unit(engine::Unit unit) const {
  if (unit == engine::Unit::radians) return angle_;
  return unit == engine::Unit::meters ? length_ : 1;
}

std::optional<double> StageValues::column(const StageProperty& property, std::size_t column) {
  const auto numbers = tuple(property, 2, 2, "[a b]");
  if (!numbers) return {};
  return (*numbers)[column];
}

std::optional<Color> StageValues::color(const StageProperty& property) {
  const auto name = text(property);
  if (!name || *name == "random") return {};
  if (const auto found = color_by_name(*name)) return found;
  warning(where(property), fmt::format("unknown colour \"{}\", replaced by red; colours are X11 names{}",
                                       *name, did_you_mean(*name, color_names())));
  return Color{};
}

std::optional<Color> StageValues::color_rgba(const StageProperty& property) {
  const auto v = tuple(property, 4, 4, "[red green blue opacity]");
  if (!v) return {};
  for (const double part : *v)
    if (part < 0 || part > 1) {
      error(where(property), fmt::format("\"{}\" needs values from 0 to 1, found {}", key(property), part));
      return {};
    }
  const auto at = [&v](std::size_t i) { return static_cast<float>((*v)[i]); };
  return Color{at(0), at(1), at(2), at(3)};
}

}  // namespace troupe::worldio
