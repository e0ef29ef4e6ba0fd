// A controller that is built outside of Troupe's tree (docs/controllers.md): it follows a wall on its left.
#include <troupe/plugin.hpp>

#include <algorithm>
#include <array>

namespace {

struct FollowWall {
  struct Params {
    double speed = 0.3;
    double distance = 0.5;

    static constexpr void describe(troupe::Description<Params>& d) {
      using namespace troupe::facts;
      using enum troupe::Unit;
      d.member<&Params::speed>("speed", meters_per_second, at_least(0), "forward speed along the wall");
      d.member<&Params::distance>("distance", meters, at_least(0), "distance to keep from the wall");
    }
  };

  Params params;

  static constexpr std::string_view text = "keep a wall at the left";
  static constexpr std::array k_uses{std::string_view("ranger")};  // its beams: from ahead to the left

  struct Memory {
    std::uint32_t corners = 0;  // number of times that a wall ahead made the robot turn
    bool turning = false;
    TROUPE_FIELDS(corners, turning)
  };

  void operator()(Memory& memory, const troupe::Percept& percept, troupe::Random&,
                  troupe::Actions& actions) const {
    const std::span<const float> ranges = percept.ranges(0);  // m, from ahead to the left
    if (ranges.empty()) return;
    const float ahead = *std::ranges::min_element(ranges.first(ranges.size() / 2 + 1));
    const bool is_blocked = ahead < 1.2 * params.distance;
    memory.corners += is_blocked && !memory.turning;
    memory.turning = is_blocked;
    const double too_far = std::clamp(ranges.back() - params.distance, -0.3, 0.3);
    actions.command = is_blocked ? troupe::Command{0, 0, -1} : troupe::Command{params.speed, 0, 2 * too_far};
  }
};

}  // namespace

TROUPE_CONTROLLER("follow_wall", FollowWall)
