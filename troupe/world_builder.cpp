#include "troupe/world_builder.hpp"

#include "base/math.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <span>
#include <stdexcept>

namespace troupe {
namespace {

std::string json_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + '"';
}

/// `between` stands between two values.
std::string list_of(std::span<const Setting> values, std::string_view between) {
  std::vector<std::string_view> texts;
  for (const Setting& value : values) texts.push_back(value.json());
  return fmt::format("{}", fmt::join(texts, between));
}

Settings device_of(std::string_view name, std::string_view kind, const Settings& parameters,
                   const Pose& pose) {
  Settings device{{"name", name}, {"kind", kind}};
  if (pose != Pose{}) device.set("pose", pose);
  return device.set(parameters);
}

}  // namespace

Setting::Setting(bool value) : json_(value ? "true" : "false") {}
Setting::Setting(double value) : json_(fmt::format("{}", value)) {  // the shortest text that is this number
  if (!std::isfinite(value))
    throw std::invalid_argument(fmt::format("a world has finite numbers, not {}", value));
}
Setting::Setting(std::int64_t value) : json_(fmt::format("{}", value)) {}
Setting::Setting(std::uint64_t value) : json_(fmt::format("{}", value)) {}
Setting::Setting(const char* text) : json_(json_text(text)) {}
Setting::Setting(std::string_view text) : json_(json_text(text)) {}
Setting::Setting(const std::string& text) : json_(json_text(text)) {}
Setting::Setting(const std::vector<Setting>& list) : json_(fmt::format("[{}]", list_of(list, ", "))) {}
Setting::Setting(std::initializer_list<Setting> list)
    : json_(fmt::format("[{}]", list_of({list.begin(), list.size()}, ", "))) {}

Setting::Setting(const Pose& pose) {
  Settings given;
  if (pose.x != 0) given.set("x_m", pose.x);
  if (pose.y != 0) given.set("y_m", pose.y);
  if (pose.z != 0) given.set("z_m", pose.z);
  if (pose.heading != 0) given.set("heading_rad", pose.heading);
  *this = Setting(given);
}

Setting::Setting(const Settings& values) {
  for (const auto& [key, value] : values.entries())
    json_ += fmt::format("{}{}: {}", json_.empty() ? "" : ", ", json_text(key), value.json());
  json_ = fmt::format("{{{}}}", json_);
}

Settings::Settings(std::initializer_list<Entry> entries) {
  for (const Entry& entry : entries) set(entry.key, entry.value);
}

Settings& Settings::set(std::string_view key, const Setting& value) {
  for (auto& [own, its_value] : entries_) {
    if (own != key) continue;
    its_value = value;
    return *this;
  }
  entries_.emplace_back(key, value);
  return *this;
}

Settings& Settings::set(const Settings& values) {
  for (const auto& [key, value] : values.entries()) set(key, value);
  return *this;
}

WorldBuilder::Type& WorldBuilder::Type::size(double x, double y, double z) {
  return set("size_m", {x, y, z});
}

WorldBuilder::Type& WorldBuilder::Type::color(const Setting& color) { return set("color", color); }

WorldBuilder::Type& WorldBuilder::Type::drive(std::string_view kind, const Settings& parameters) {
  return set("drive", Settings{{"kind", kind}}.set(parameters));
}

WorldBuilder::Type& WorldBuilder::Type::sensor(std::string_view name, std::string_view kind,
                                               const Settings& parameters, const Pose& pose) {
  sensors_.push_back(device_of(name, kind, parameters, pose));
  return *this;
}

WorldBuilder::Type& WorldBuilder::Type::device(std::string_view name, std::string_view kind,
                                               const Settings& parameters, const Pose& pose) {
  devices_.push_back(device_of(name, kind, parameters, pose));
  return *this;
}

WorldBuilder::Type& WorldBuilder::Type::controller(std::string_view kind, const Settings& parameters) {
  return set("controller", Settings{{"kind", kind}}.set(parameters));
}

WorldBuilder::Type& WorldBuilder::Type::set(std::string_view key, const Setting& value) {
  values_.set(key, value);
  return *this;
}

WorldBuilder::WorldBuilder(std::filesystem::path name) : name_(std::move(name)) {
  if (name_.extension() != ".json") name_ += ".json";
}

WorldBuilder& WorldBuilder::set(std::string_view key, const Setting& value) {
  values_.set(key, value);
  return *this;
}

WorldBuilder::Type& WorldBuilder::type(std::string_view name) {
  for (Type& type : types_)
    if (type.name_ == name) return type;
  return types_.emplace_back(Type::Key(), name);
}

WorldBuilder& WorldBuilder::add(std::string_view name, std::string_view type, const Pose& pose,
                                const Settings& more) {
  models_.push_back(Settings{{"name", name}, {"type", type}, {"pose", pose}}.set(more));
  return *this;
}

WorldBuilder& WorldBuilder::population(std::string_view name, std::string_view type, std::size_t count,
                                       const Settings& place, const Settings& more) {
  populations_.push_back(
      Settings{{"name", name}, {"type", type}, {"count", count}, {"place", place}}.set(more));
  return *this;
}

WorldBuilder& WorldBuilder::wall(const Vec2& from, const Vec2& to, double thickness, double height) {
  const Vec2 along = to - from;
  const double length = std::sqrt(along.squaredNorm());
  if (!(length > 0)) throw std::invalid_argument("a wall from a point to itself");
  const std::string name = fmt::format("wall{}", ++walls_);
  type(name).size(length, thickness, height).color("gray40");
  const Vec2 middle = (from + to) / 2;
  return add(name, name, {middle.x(), middle.y(), 0, atan2(along.y(), along.x())});
}

WorldBuilder& WorldBuilder::floorplan(std::string_view name, const std::filesystem::path& bitmap, double x,
                                      double y, double height, const Settings& more) {
  floorplans_.push_back(
      Settings{{"name", name}, {"bitmap", bitmap.string()}, {"size_m", {x, y, height}}}.set(more));
  return *this;
}

std::string WorldBuilder::json() const {
  std::string out = "{\n  \"troupe\": 1";
  for (const auto& [key, value] : values_.entries())
    out += fmt::format(",\n  {}: {}", json_text(key), value.json());
  const auto add_list = [&out](std::string_view key, std::span<const Setting> values,
                               std::string_view indent) {
    if (values.empty()) return;
    const std::string between = fmt::format(",\n{}  ", indent);
    out += fmt::format(",\n{0}\"{1}\": [\n{0}  {2}\n{0}]", indent, key, list_of(values, between));
  };
  add_list("floorplans", floorplans_, "  ");
  out += ",\n  \"types\": {";
  for (const Type& type : types_) {
    out += fmt::format("{}\n    {}: {{", &type == &types_.front() ? "" : ",", json_text(type.name_));
    std::string members;  // each behind a comma and in a line of its own
    std::swap(out, members);
    for (const auto& [key, value] : type.values_.entries())
      out += fmt::format(",\n      {}: {}", json_text(key), value.json());
    add_list("sensors", type.sensors_, "      ");
    add_list("devices", type.devices_, "      ");
    std::swap(out, members);
    out += members.substr(members.empty() ? 0 : 1) + "\n    }";
  }
  out += "\n  }";
  add_list("models", models_, "  ");
  add_list("populations", populations_, "  ");
  return out + "\n}\n";
}

}  // namespace troupe
