#include "engine/world/state_tables.hpp"

#include "engine/kinds/components.hpp"
#include "engine/kinds/device_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace troupe::engine {
namespace {

using Layout = StateTable::Layout;

void add_carrier_table(WorldState& state) {
  state.carrier_table = state.tables.size();
  state.tables.emplace_back(
      "carrier", HashGroup::pose, Layout::rows,
      sparse({{"carrier", Element::u32, 1, "", "id of the body that carries this body, plus 1; 0: none"},
              {"joint", Element::u32, 1, "",
               "joint of the carrier that holds this body, counted from 1; 0: none"},
              {"x", Element::f64, 1, "m",
               "position of this body in the frame of the carrier; if `joint` is not 0, this frame moves "
               "with the joint"},
              {"y", Element::f64, 1, "m", "in the same frame as x"},
              {"z", Element::f64, 1, "m", "in the same frame as x"},
              {"heading", Element::f64, 1, "rad", "in the same frame as x"}}),
      state.bodies);
}

// The functions below add the tables of one type. These have one row for each of `bodies`, the bodies of the
// type.

void add_joint_tables(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  for (BodyType::Joint& joint : type.joints) {
    joint.table = tables.size();
    tables.emplace_back(
        fmt::format("joint/{}", joint.name), HashGroup::pose, Layout::rows,
        std::vector<StateField>{
            {"x", Element::f64, 1, "m", "relative to the joint's rest pose"},
            {"y", Element::f64, 1, "m", "relative to the joint's rest pose"},
            {"z", Element::f64, 1, "m", "relative to the joint's rest pose"},
            {"heading", Element::f64, 1, "rad", "relative to the joint's rest pose; not wrapped"}},
        bodies);
  }
}

void add_odometry_table(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  if (!type.drive || type.drive->localization.kind != Localization::Kind::odom) return;
  type.drive->odometry_table = tables.size();
  tables.emplace_back(
      "odometry", HashGroup::memory, Layout::rows,
      std::vector<StateField>{{"x", Element::f64, 1, "m", "estimated position"},
                              {"y", Element::f64, 1, "m", "estimated position"},
                              {"heading", Element::f64, 1, "rad", "estimated heading, counter-clockwise"}},
      bodies);
}

void add_device_tables(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  for (BodyType::Device& device : type.devices) {
    const DeviceKind::Prepared& prepared = device.prepared;
    // Component names, which are hashed, do not contain the name of the type. Types only save memory: two
    // files may divide the same bodies into types differently, and the hashes must not depend on that.
    const std::string component = fmt::format("{}/{}", device.kind->name, device.name);
    device.table = tables.size();
    tables.emplace_back(component, HashGroup::sensor, Layout::rows, prepared.percepts, bodies,
                        prepared.percept_bytes);
    if (prepared.commands.empty()) continue;
    device.command_table = tables.size();
    tables.emplace_back(component + "/command", HashGroup::velocity, Layout::rows, prepared.commands, bodies,
                        prepared.command_bytes);
  }
}

void add_memory_tables(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  for (std::size_t c = 0; c < type.controllers.size(); ++c) {
    BodyType::Controller& controller = type.controllers[c];
    if (controller.kind->memory.empty()) continue;
    controller.table = tables.size();
    tables.emplace_back(fmt::format("{}/{}", controller.kind->name, c), HashGroup::memory, Layout::rows,
                        controller.kind->memory, bodies, controller.kind->memory_bytes);
  }
}

void add_type_tables(BodyType& type, const std::vector<BodyId>& bodies, std::vector<StateTable>& tables) {
  add_joint_tables(type, bodies, tables);
  add_odometry_table(type, bodies, tables);
  add_device_tables(type, bodies, tables);
  add_memory_tables(type, bodies, tables);
}

}  // namespace

void add_common_tables(WorldState& state) {
  state.tables.emplace_back(
      "pose", HashGroup::pose, Layout::rows,
      std::vector<StateField>{{"x", Element::f64, 1, "m", "world frame"},
                              {"y", Element::f64, 1, "m", "world frame"},
                              {"z", Element::f64, 1, "m", "world frame"},
                              {"heading", Element::f64, 1, "rad", "counter-clockwise from +x"}},
      state.bodies);
  state.tables.emplace_back(
      "velocity", HashGroup::velocity, Layout::rows,
      std::vector<StateField>{{"x", Element::f64, 1, "m/s", "forward speed, as the drive computed it"},
                              {"y", Element::f64, 1, "m/s", "speed to the left"},
                              {"turn", Element::f64, 1, "rad/s", "turn rate, counter-clockwise"}},
      state.bodies);
  state.tables.emplace_back("command", HashGroup::velocity, Layout::rows, command_fields(), state.bodies,
                            sizeof(Command));
  state.tables.emplace_back(
      "stall", HashGroup::velocity, Layout::columns,
      std::vector<StateField>{
          {"stalled", Element::u8, 1, "",
           "1: last motion was blocked, 2: last motion would have ended out of bounds, 0: neither"}},
      state.bodies);
  if (std::ranges::any_of(state.types, &BodyType::carries)) add_carrier_table(state);
}

void add_contact_table(WorldState& state) {
  const auto reads_contacts = [](const BodyType& type) {
    return std::ranges::any_of(type.controllers, [](const BodyType::Controller& controller) {
      return controller.kind->reads_contacts;
    });
  };
  if (!state.spec.contacts && std::ranges::none_of(state.types, reads_contacts)) return;
  state.contact_table = state.tables.size();
  state.tables.emplace_back(
      "contact", HashGroup::velocity, Layout::rows,
      sparse(
          {{"cause", Element::u32, 1, "",
            "what blocked the body in the last tick: 0 nothing, 1 another body, 2 a body that it would have "
            "pushed, 3 the bounds of the world, 4 a body in the way of a joint",
            offsetof(Contact, cause)},
           {"body", Element::u32, 1, "", "id of the body that blocked the motion, plus 1; 0: none",
            offsetof(Contact, body)},
           {"behind", Element::u32, 1, "", "id of the body that stops the pushed body, plus 1; 0: none",
            offsetof(Contact, behind)}}),
      state.bodies, sizeof(Contact));
}

void add_tables_of_types(WorldState& state) {
  std::vector<std::vector<BodyId>> bodies(state.types.size());  // by type
  for (std::size_t r = 0; r < state.row_count(); ++r) bodies[state.row_types[r]].push_back(state.bodies[r]);
  for (std::size_t t = 0; t < state.types.size(); ++t)
    if (!bodies[t].empty()) add_type_tables(state.types[t], bodies[t], state.tables);
}

std::vector<StateTable> unused_tables(const WorldState& state) {
  std::vector<bool> is_used(state.types.size(), false);
  for (const BodySpec& body : state.spec.bodies) is_used[body.type.index()] = true;
  std::vector<StateTable> tables;
  for (std::size_t t = 0; t < is_used.size(); ++t) {
    if (is_used[t] || !state.types[t].runs()) continue;
    BodyType type = state.types[t];  // a copy, because the members for indices of tables are set
    add_type_tables(type, {}, tables);
  }
  return tables;
}

}  // namespace troupe::engine
