#include "troupe/world_builder.hpp"

#include "base/math.hpp"
#include "base/number_text.hpp"
#include "worldio/json/json_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

namespace troupe {
namespace {

using worldio::add_member;
using worldio::add_node;
using worldio::json_node;
using worldio::JsonMember;
using worldio::JsonNode;

std::shared_ptr<const JsonNode> shared(JsonNode node) {
  return std::make_shared<const JsonNode>(std::move(node));
}

/// Returns the same node that a JSON reader makes of this number: an integer if the number has no fraction.
JsonNode number_node(double value) {
  const std::string text = fmt::format("{}", value);  // the shortest text that reads as this number
  const std::optional<std::int64_t> whole = number_of<std::int64_t>(text);
  return whole ? json_node(*whole) : json_node(value);
}

Settings device_of(std::string_view name, std::string_view kind, const Settings& parameters,
                   const Pose& pose) {
  Settings device{{"name", name}, {"kind", kind}};
  if (pose != Pose{}) device.set("pose", pose);
  return device.set(parameters);
}

/// A special line number: it marks a value whose members Layout must write on separate lines. Layout then
/// replaces it by the real line number.
constexpr std::uint32_t k_broken = 1;

/// Writes a world as JSON text, and stores in each value the number of its line.
class Layout {
 public:
  explicit Layout(std::uint32_t file) : where_{file, 1} {}

  std::string write(JsonNode& world) {
    add(world, 0);
    return text_ + '\n';
  }

 private:
  void add(JsonNode& node, std::size_t indent) {
    const bool is_broken = node.where.line == k_broken;
    node.where = where_;
    if (!is_broken) {
      text_ += worldio::json_line(node);
      place(node);
      return;
    }
    auto* list = std::get_if<JsonNode::List>(&node.value);
    auto* object = std::get_if<JsonNode::Object>(&node.value);
    text_ += list ? '[' : '{';
    bool is_first = true;
    const auto begin_line = [&] {
      if (!is_first) text_ += ',';
      is_first = false;
      end_line(indent + 2);
    };
    if (list)
      for (JsonNode& item : *list) {
        begin_line();
        add(item, indent + 2);
      }
    if (object)
      for (JsonMember& member : *object) {
        begin_line();
        member.where = where_;
        text_ += fmt::format("{}: ", worldio::json_line(json_node(member.key)));
        add(member.node, indent + 2);
      }
    end_line(indent);
    text_ += list ? ']' : '}';
  }

  /// Gives all members of a value, at any depth, the line number of the value.
  static void place(JsonNode& node) {
    if (auto* list = std::get_if<JsonNode::List>(&node.value))
      for (JsonNode& item : *list) {
        item.where = node.where;
        place(item);
      }
    if (auto* object = std::get_if<JsonNode::Object>(&node.value))
      for (JsonMember& member : *object) {
        member.where = member.node.where = node.where;
        place(member.node);
      }
  }

  void end_line(std::size_t indent) {
    text_ += '\n';
    text_.append(indent, ' ');
    ++where_.line;
  }

  Where where_;
  std::string text_;
};

}  // namespace

Setting::Setting(bool value) : node_(shared(json_node(value))) {}
Setting::Setting(double value) {
  if (!std::isfinite(value))
    throw std::invalid_argument(fmt::format("numbers in a world must be finite, found {}", value));
  node_ = shared(number_node(value));
}
Setting::Setting(std::int64_t value) : node_(shared(json_node(value))) {}
Setting::Setting(std::uint64_t value)
    : node_(shared(std::in_range<std::int64_t>(value) ? json_node(static_cast<std::int64_t>(value))
                                                      : json_node(value))) {}
Setting::Setting(const char* text) : Setting(std::string(text)) {}
Setting::Setting(std::string_view text) : Setting(std::string(text)) {}
Setting::Setting(const std::string& text) : node_(shared(json_node(text))) {}
Setting::Setting(std::initializer_list<Setting> list) : Setting(std::vector<Setting>(list)) {}
Setting::Setting(const std::vector<Setting>& list) {
  JsonNode::List nodes;
  for (const Setting& value : list) nodes.push_back(*value.node_);
  node_ = shared(json_node(std::move(nodes)));
}

Setting::Setting(const Pose& pose) {
  Settings given;
  if (pose.x != 0) given.set("x_m", pose.x);
  if (pose.y != 0) given.set("y_m", pose.y);
  if (pose.z != 0) given.set("z_m", pose.z);
  if (pose.heading != 0) given.set("heading_rad", pose.heading);
  *this = Setting(given);
}

Setting::Setting(const Settings& values) {
  JsonNode::Object object;
  for (const auto& [key, value] : values.entries()) add_node(object, key, *value.node_);
  node_ = shared(json_node(std::move(object)));
}

std::string Setting::json() const { return worldio::json_line(*node_); }

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
  if (const auto found = numbers_.find(name); found != numbers_.end()) return types_[found->second];
  numbers_.emplace(name, types_.size());
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
  if (!(length > 0 && std::isfinite(length)))
    throw std::invalid_argument(
        fmt::format("wall(): the end points must be finite and different, found ({}, {}) m and ({}, {}) m",
                    from.x(), from.y(), to.x(), to.y()));
  if (!std::isfinite(thickness) || !std::isfinite(height))
    throw std::invalid_argument(fmt::format(
        "wall(): the thickness and the height must be finite, found {} m and {} m", thickness, height));
  std::string name;
  do name = fmt::format("wall{}", ++walls_);
  while (numbers_.contains(name));
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
  JsonNode world = unplaced();
  return Layout(Where::k_no_file).write(world);
}

JsonNode WorldBuilder::node(std::uint32_t file) const {
  JsonNode world = unplaced();
  Layout(file).write(world);
  return world;
}

JsonNode WorldBuilder::unplaced() const {
  constexpr Where k_in_lines{Where::k_no_file, k_broken};
  const auto add_values = [](const Settings& values, JsonNode::Object& object) {
    for (const auto& [key, value] : values.entries()) add_node(object, key, *value.node_);
  };
  const auto add_list = [&](std::string_view key, std::span<const Setting> values, JsonNode::Object& object) {
    JsonNode::List list;
    for (const Setting& value : values) list.push_back(*value.node_);
    if (!list.empty()) add_member(object, key, std::move(list), k_in_lines);
  };
  JsonNode::Object world;
  add_member(world, "troupe", std::int64_t{1});
  add_values(values_, world);
  add_list("floorplans", floorplans_, world);
  JsonNode::Object types;
  for (const Type& type : types_) {
    JsonNode::Object members;
    add_values(type.values_, members);
    add_list("sensors", type.sensors_, members);
    add_list("devices", type.devices_, members);
    add_member(types, type.name_, std::move(members), k_in_lines);
  }
  add_member(world, "types", std::move(types), k_in_lines);
  add_list("models", models_, world);
  add_list("populations", populations_, world);
  return json_node(std::move(world), k_in_lines);
}

}  // namespace troupe
