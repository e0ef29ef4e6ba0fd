#include "models/waypoints.hpp"

#include "engine/controller.hpp"

namespace troupe::models {
namespace {

using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Unit;

const FieldTable& waypoint_fields() {
  static const FieldTable table{{
      {.name = "goals",
       .type = FieldType::records,
       .text = "where to, one after another, in the frame of the robot's localization",
       .record = &engine::pose_fields()},
      {.name = "near",
       .unit = Unit::meters,
       .fallback = 0.1,
       .min = 0.03,  // drives come within 0.02 m along both axes
       .text = "how near it believes to be when it goes on to the next"},
      {.name = "again",
       .type = FieldType::boolean,
       .fallback = false,
       .text = "begins again after the last goal; otherwise it stays there"},
  }};
  return table;
}

struct Waypoints {
  struct Memory {
    std::uint32_t goal = 0;  ///< the one it goes to
    TROUPE_FIELDS(goal)
  };

  std::vector<Pose> goals;
  double near;
  bool again;

  static Waypoints make(const Record& p) {
    Waypoints waypoints{{}, p[1].number(), p[2].boolean()};
    for (const Record& goal : p[0].records()) {
      const auto at = [&](std::string_view name) {
        return engine::get(engine::pose_fields(), goal, name).number();
      };
      waypoints.goals.push_back({at("x"), at("y"), 0, at("heading")});
    }
    return waypoints;
  }

  std::vector<std::size_t> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&,
                                  std::string& fault) const {
    if (goals.empty()) fault = "needs goals: without them it has nowhere to go";
    return {};
  }

  void operator()(Memory& memory, const engine::Percept& percept, Random&, engine::Actions& actions) const {
    const Vec2 missing = goals[memory.goal].position() - percept.estimate.position();
    if (missing.squaredNorm() <= near * near) {
      if (memory.goal + 1 < goals.size())
        ++memory.goal;
      else if (again)
        memory.goal = 0;
    }
    const Pose& goal = goals[memory.goal];
    actions.go_to(goal.x, goal.y, goal.heading);
  }
};

}  // namespace

engine::ControllerKind waypoints_controller() {
  return engine::make_controller_kind<Waypoints>(
      "waypoints", "go from goal to goal by where it believes to be", waypoint_fields());
}

}  // namespace troupe::models
