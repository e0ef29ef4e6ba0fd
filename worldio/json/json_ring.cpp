#include "worldio/json/json_ring.hpp"

#include "base/math.hpp"
#include "base/pose.hpp"
#include "engine/fields/description.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/read_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::worldio {
namespace {

/// Calls visit(name) for the name of an entry, of its own device, and of each entry of its lists of sensors,
/// devices and parts. Node: JsonNode or const JsonNode
template <class Node, class Visit>
void for_each_name(Node& entry, const Visit& visit) {
  auto* members = std::get_if<JsonNode::Object>(&entry.value);
  if (!members) return;
  for (auto& member : *members) {
    if (auto* name = std::get_if<std::string>(&member.node.value); name && member.key == "name") visit(*name);
    if (member.key == "device") for_each_name(member.node, visit);
    auto* list = std::get_if<JsonNode::List>(&member.node.value);
    if (!list || !is_named_list(member.key)) continue;
    for (auto& inner : *list) for_each_name(inner, visit);
  }
}

/// Calls visit(text) for each text in a value that is the name of a device or of a joint of a device.
template <class Visit>
void for_each_reference(JsonNode& node, const Visit& visit) {
  constexpr std::array<std::string_view, 3> k_references{"on", "joint", "device"};
  if (auto* list = std::get_if<JsonNode::List>(&node.value))
    for (JsonNode& entry : *list) for_each_reference(entry, visit);
  auto* members = std::get_if<JsonNode::Object>(&node.value);
  if (!members) return;
  for (JsonMember& member : *members) {
    auto* text = std::get_if<std::string>(&member.node.value);
    if (text && std::ranges::find(k_references, member.key) != k_references.end())
      visit(*text);
    else
      for_each_reference(member.node, visit);
  }
}

/// Appends a number to the names in a copy of an entry, because all devices of a type must have different
/// names, and to the references to these names in the copy. The keys `on` and `joint` of the entry itself
/// refer to devices outside of the copy. names: the names in the entry
void number_names(JsonNode& copy, const std::set<std::string>& names, std::size_t number) {
  const std::string digits = fmt::format("{}", number);
  const auto add_to = [&](std::string& reference) {
    // A joint of a gripper is called GRIPPER/left or GRIPPER/right.
    const std::size_t end = names.contains(reference) ? reference.size() : reference.rfind('/');
    if (names.contains(reference.substr(0, end))) reference.insert(std::min(end, reference.size()), digits);
  };
  for (JsonMember& member : std::get<JsonNode::Object>(copy.value)) for_each_reference(member.node, add_to);
  for_each_name(copy, [&](std::string& name) { name += digits; });
}

Pose pose_of(const JsonCursor& at) {
  const JsonNode* node = at.node().find("pose");
  if (!node) return {};
  const JsonCursor cursor(at, "pose", *node);
  JsonObject object(cursor);
  const engine::Record record = read_fields(object, engine::pose_fields());
  object.finish();
  return engine::from_record<Pose>(record);
}

JsonNode pose_node(const Pose& pose, Where where) {
  JsonNode::Object object;
  add_member(object, "x_m", pose.x, where);
  add_member(object, "y_m", pose.y, where);
  add_member(object, "z_m", pose.z, where);
  add_member(object, "heading_rad", pose.heading, where);
  return json_node(std::move(object), where);
}

/// Returns the number of copies that replace a value: the `count` of its ring, or 1 if the value has no ring
/// or if its `count` is not a valid number of copies.
double copies_of(const JsonNode& node) {
  const JsonNode* ring = node.object() ? node.find("ring") : nullptr;
  const JsonNode* count = ring && ring->object() ? ring->find("count") : nullptr;
  const std::optional<std::int64_t> copies = count ? whole_number_of(*count) : std::nullopt;
  if (!copies || *copies < 1) return 1;
  const auto number = static_cast<double>(*copies);
  return number <= document_table<RingDocument>().find("count")->field.max ? number : 1;
}

/// Returns the number of JSON objects in a value after its rings are expanded, including the value itself.
double expanded_objects(const JsonNode& node) {
  double objects = 0;
  if (const JsonNode::List* list = node.list())
    for (const JsonNode& entry : *list) objects += expanded_objects(entry);
  const JsonNode::Object* members = node.object();
  if (!members) return objects;
  for (const JsonMember& member : *members)
    if (member.key != "ring") objects += expanded_objects(member.node);
  return copies_of(node) * (objects + 1);
}

/// Adds the objects that the rings in the value at `at` make to `objects`.
void count_ring_objects(const JsonCursor& at, double& objects) {
  const JsonNode& node = at.node();
  if (copies_of(node) > 1) {
    objects += expanded_objects(node);
    if (objects <= static_cast<double>(k_most_ring_objects)) return;
    const JsonNode& ring = *node.find("ring");
    JsonCursor(at, "ring", ring)
        .error(fmt::format("up to here, the rings of the world make more than {} objects, which is the limit "
                           "for the copies and the objects in the copies: reduce \"count\"",
                           k_most_ring_objects));
    at.diagnostics().throw_if_errors();
  }
  if (const JsonNode::List* list = node.list())
    for (std::size_t i = 0; i < list->size(); ++i) count_ring_objects(JsonCursor(at, i, (*list)[i]), objects);
  if (const JsonNode::Object* members = node.object())
    for (const JsonMember& member : *members)
      count_ring_objects(JsonCursor(at, member.key, member.node), objects);
}

}  // namespace

bool is_named_list(std::string_view key) {
  constexpr std::array<std::string_view, 3> k_lists{"sensors", "devices", "parts"};
  return std::ranges::find(k_lists, key) != k_lists.end();
}

void check_rings(const JsonCursor& root) {
  double objects = 0;
  count_ring_objects(root, objects);
}

std::vector<JsonNode> expand_ring(const JsonCursor& at) {
  const JsonNode& described = *at.node().find("ring");
  const std::size_t before = at.diagnostics().findings().size();
  const engine::Registry no_kinds;
  const auto ring = read_document<RingDocument>(JsonCursor(at, "ring", described), {no_kinds, 0});
  const Pose center = pose_of(at);
  if (at.diagnostics().findings().size() > before) return {};
  std::set<std::string> names;
  for_each_name(at.node(), [&](const std::string& name) { names.insert(name); });
  std::vector<JsonNode> copies;
  for (std::int64_t i = 0; i < ring.count; ++i) {
    const double angle = ring.start + 2 * k_pi * static_cast<double>(i) / static_cast<double>(ring.count);
    const SinCos direction = sincos(angle);
    const Pose pose = compose(center, {ring.radius * direction.cos, ring.radius * direction.sin, 0, angle});
    JsonNode& copy = copies.emplace_back(at.node());
    auto& members = std::get<JsonNode::Object>(copy.value);
    std::erase_if(members,
                  [](const JsonMember& member) { return member.key == "ring" || member.key == "pose"; });
    add_node(members, "pose", pose_node(pose, described.where));
    number_names(copy, names, static_cast<std::size_t>(i));
  }
  return copies;
}

}  // namespace troupe::worldio
