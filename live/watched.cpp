#include "live/watched.hpp"

#include "engine/observing/frame.hpp"
#include "engine/observing/sensed_rows.hpp"
#include "troupe/frame_data.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string_view>
#include <utility>

namespace troupe::live {
namespace {

using engine::FrameLayer;
using engine::StateField;
using engine::StateTable;
using WatchedJson = nlohmann::ordered_json;

// Numbers of a field that are shown. Leaves out most of a camera image, whose numbers are of no use here.
constexpr std::uint32_t k_most_values = 2048;
constexpr std::uint32_t k_few = 4;           // columns of a field that are listed one by one
constexpr std::size_t k_most_lines = 20000;  // lines of a layer

// Names of layers.
constexpr std::string_view k_radio = "radio";
constexpr std::string_view k_sights = "sights";
constexpr std::string_view k_grips = "grips";
constexpr std::string_view k_carries = "carries";

/// Returns one column of a field, or the minimum of all columns if none is given.
double value_of(const StateTable& table, std::size_t row, std::size_t f,
                std::optional<std::uint32_t> column) {
  if (column) return table.number(row, f, *column);
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t c = 0; c < table.fields()[f].columns; ++c)
    least = std::min(least, table.number(row, f, c));
  return least;
}

std::optional<std::size_t> field_index(std::span<const StateField> fields, std::string_view name) {
  const StateField* const found = engine::field_named(fields, name);
  if (found == nullptr) return {};
  return static_cast<std::size_t>(found - fields.data());
}

/// Appends a line, rounded to 1 mm.
void append_line(WatchedJson& lines, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  if (lines.size() >= 6 * k_most_lines) return;
  for (const Eigen::Vector3d& point : {from, to})
    for (const double x : point) lines.push_back(std::round(x * 1000) / 1000);
}

Eigen::Vector3d place_of(const engine::World& world, BodyId body) {
  const Pose pose = world.view().pose(body);
  return {pose.x, pose.y, pose.z};
}

/// The fields of the state of a device that receives messages, as indices.
struct MessageFields {
  std::size_t count;   ///< number of messages that it received
  std::size_t sender;  ///< id of the body that sent each message
};

/// Returns std::nullopt if the device receives no messages. It is recognised by these fields, and not by its
/// kind, so that devices of plug-ins have the layer "radio", too.
std::optional<MessageFields> message_fields(const engine::BodyType::Device& device) {
  const std::span<const StateField> fields = device.prepared.percepts;
  const auto count = field_index(fields, "count");
  const auto sender = field_index(fields, "sender");
  const auto holds_u32 = [&](const std::optional<std::size_t>& f) {
    return f && fields[*f].element == engine::Element::u32;
  };
  if (!holds_u32(count) || !holds_u32(sender)) return {};
  return MessageFields{*count, *sender};
}

/// Appends a line from each sender to each robot that heard it in the last tick in which its radio was due.
/// Radios that do not run, such as those of disabled robots, have no lines: they keep their last readings.
void append_heard(const engine::World& world, const engine::Frame& frame, WatchedJson& lines) {
  for (const engine::FrameBody& body : frame.mobile) {
    const BodyId id(body.id);
    const Row row = world.view().row(id);
    for (const engine::BodyType::Device& device : world.view().type(row).devices) {
      const std::optional<MessageFields> fields = message_fields(device);
      if (!fields || !world.view().runs(row, device)) continue;
      const StateTable& table = world.tables()[device.table];
      const std::size_t slot = world.view().slot(row);
      const auto senders = table.cell<std::uint32_t>(slot, fields->sender);
      const std::size_t heard =
          std::min<std::size_t>(table.cell<std::uint32_t>(slot, fields->count).front(), senders.size());
      for (const std::uint32_t from : senders.first(heard))
        if (from < world.spec().bodies.size())
          append_line(lines, place_of(world, BodyId(from)), place_of(world, id));
    }
  }
}

/// Returns the present commands to the devices of a body as JSON: {device: {field: [numbers]}}, without
/// fields of many columns, such as the bytes of a message.
WatchedJson commands_of(Model& model, const engine::BodyType& type) {
  WatchedJson commands = WatchedJson::object();
  for (const engine::BodyType::Device& device : type.devices) {
    if (!device.command_table || !model.is_alive()) continue;
    const Model::Asked asked = model.asked(device.name);
    WatchedJson& fields = commands[device.name] = WatchedJson::object();
    for (const StateField& field : asked.fields) {
      if (field.columns > k_few) continue;
      WatchedJson& values = fields[field.name] = WatchedJson::array();
      for (std::uint32_t c = 0; c < field.columns; ++c)
        values.push_back(engine::number_at(
            field.element, asked.bytes.data() + field.offset + c * engine::element_size(field.element)));
    }
  }
  return commands;
}

/// What blocked the row's body in the last tick, for a reader; empty if nothing did.
std::string blocker_text(const engine::World& world, Row row) {
  const engine::Contact contact = world.view().contact(row);
  const auto name = [&](BodyId body) { return world.spec().name(body); };
  switch (contact.cause) {
    case engine::Contact::k_body: return name(contact.blocker());
    case engine::Contact::k_pushed:
      return fmt::format("{}, which {} stops", name(contact.blocker()),
                         contact.behind == 0 ? "a bound or a limit" : name(contact.stopper()));
    case engine::Contact::k_bounds: return "the bounds of the world";
    case engine::Contact::k_joint: return fmt::format("{}, in the way of a joint", name(contact.blocker()));
    default: return {};
  }
}

bool has_device(const engine::World& world, auto&& wanted) {
  return std::ranges::any_of(world.view().types(), [&](const engine::BodyType& type) {
    return std::ranges::any_of(type.devices, wanted);
  });
}

}  // namespace

WatchedJson inspection(Simulation& simulation, BodyId id) {
  const engine::World& world = simulation.world();
  Model model = simulation.model(id);
  const Row row = world.view().row(id);
  WatchedJson json{
      {"robot", model.name()}, {"alive", model.is_alive()}, {"components", WatchedJson::array()}};
  if (!row.valid()) return json;
  const Pose pose = world.view().pose(id);
  json["pose"] = {pose.x, pose.y, pose.z, pose.heading};
  for (const StateTable& table : world.tables()) {
    const std::size_t at = world.view().row_in(table, row);
    if (at >= table.rows() || table.ids()[at] != id || table.component() == "pose") continue;
    const bool runs = engine::SensedRows(world.view(), table).exist(world.view(), at);
    WatchedJson fields = WatchedJson::array();
    for (std::size_t f = 0; f < table.fields().size(); ++f) {
      const StateField& field = table.fields()[f];
      WatchedJson values = WatchedJson::array();
      for (std::uint32_t c = 0; c < std::min(field.columns, k_most_values); ++c)
        values.push_back(runs ? value_of(table, at, f, c) : std::numeric_limits<double>::quiet_NaN());
      fields.push_back(
          {{"name", field.name}, {"unit", field.unit}, {"text", field.text}, {"values", values}});
    }
    json["components"].push_back({{"component", table.component()},
                                  {"name", engine::given_name(table.component())},
                                  {"runs", runs},
                                  {"fields", std::move(fields)}});
  }
  json["blocked_by"] = blocker_text(world, row);
  json["eyes"] = WatchedJson::object();
  for (const engine::BodyType::Device& device : world.view().type(row).devices) {
    if (device.prepared.transducers.empty() || !world.view().senses(row, device)) continue;
    // The name in the header of the page.
    json["eyes"][worldio::hdf5_name(device.name)] =
        world.tables()[device.table].cell<float>(world.view().slot(row), 0);
  }
  json["commands"] = commands_of(model, world.view().type(row));
  return json;
}

WatchedJson color_values(const engine::World& world) {
  WatchedJson values = WatchedJson::array();
  std::set<std::pair<std::string_view, std::string_view>> listed;  // components and fields
  for (const StateTable& table : world.tables())
    for (const StateField& field : table.fields()) {
      // Bodies of different types can have the same component, and then share its entry.
      if (!listed.emplace(table.component(), field.name).second) continue;
      values.push_back({{"component", table.component()},
                        {"field", field.name},
                        {"unit", field.unit},
                        {"text", field.text},
                        {"columns", field.columns <= k_few ? field.columns : 0}});
    }
  return values;
}

bool has_value(const engine::World& world, const ColorValue& color) {
  return std::ranges::any_of(world.tables(), [&](const StateTable& table) {
    if (!engine::selects(color.component, table.component())) return false;
    const std::optional<std::size_t> field = field_index(table.fields(), color.field);
    return field && color.column.value_or(0) < table.fields()[*field].columns;
  });
}

void take_shades(const engine::World& world, std::span<const std::uint32_t> places, std::size_t robots,
                 ColorValue& color, std::vector<std::uint8_t>& shades) {
  std::vector<double> values(robots, std::numeric_limits<double>::quiet_NaN());
  for (const StateTable& table : world.tables()) {
    if (!engine::selects(color.component, table.component())) continue;
    const std::optional<std::size_t> field = field_index(table.fields(), color.field);
    if (!field || color.column.value_or(0) >= table.fields()[*field].columns) continue;
    const engine::SensedRows readings(world.view(), table);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const BodyId id = table.ids()[row];
      const std::uint32_t place = places[id.index()];
      if (place >= robots || !world.view().is_there(world.view().row(id)) ||
          !readings.exist(world.view(), row))
        continue;
      const double value = value_of(table, row, *field, color.column);
      if (!std::isfinite(value)) continue;
      values[place] = value;
      color.least = std::min(color.least, value);
      color.most = std::max(color.most, value);
    }
  }
  constexpr double k_shades = 254;
  // Half the differences, because the difference of two finite values can be infinite.
  const auto above_least = [&color](double value) { return 0.5 * value - 0.5 * color.least; };
  const double range = above_least(color.most);
  shades.assign(robots, 0);
  for (std::size_t r = 0; r < robots; ++r)
    if (!std::isnan(values[r])) {
      const double fraction = range > 0 ? above_least(values[r]) / range : 0;
      shades[r] = static_cast<std::uint8_t>(1 + std::lround(fraction * k_shades));
    }
}

std::vector<std::string_view> layers_of(const engine::World& world) {
  std::vector<std::string_view> layers;
  const auto draws = [](FrameLayer layer) {
    return [layer](const engine::BodyType::Device& device) { return device.kind->layer == layer; };
  };
  const auto receives = [](const engine::BodyType::Device& device) {
    return message_fields(device).has_value();
  };
  if (has_device(world, receives)) layers.push_back(k_radio);
  if (has_device(world, draws(FrameLayer::sights))) layers.push_back(k_sights);
  if (has_device(world, draws(FrameLayer::grips))) {
    layers.push_back(k_grips);
    layers.push_back(k_carries);
  }
  return layers;
}

WatchedJson lines_of(const engine::World& world, std::span<const std::string> layers) {
  engine::Frame frame = engine::make_frame(world);
  WatchedJson all = WatchedJson::object();
  for (const std::string& layer : layers) {
    WatchedJson& lines = all[layer] = WatchedJson::array();
    if (layer == k_radio) append_heard(world, frame, lines);
    if (layer == k_sights) {
      add_layer(world, FrameLayer::sights, frame);
      for (const engine::FrameSight& sight : frame.sights) append_line(lines, sight.from, sight.to);
    }
    if (layer == k_grips) {
      add_layer(world, FrameLayer::grips, frame);
      for (const engine::FrameTie& tie : frame.grips) append_line(lines, tie.from, tie.to);
    }
    if (layer == k_carries) {
      add_links(world, frame);
      for (const engine::FrameTie& tie : frame.links) append_line(lines, tie.from, tie.to);
    }
  }
  return all;
}

}  // namespace troupe::live
