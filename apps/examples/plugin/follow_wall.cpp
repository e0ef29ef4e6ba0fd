// A controller that is built outside of Troupe's tree (docs/controllers.md): it keeps a wall at its left.
#include <troupe/plugin.hpp>

#include <algorithm>
#include <array>

namespace {

struct FollowWall {
  double speed, distance;

  static constexpr std::string_view text = "keep a wall at the left";
  static constexpr std::array k_uses{std::string_view("ranger")};  // one that looks ahead and to the left
  static troupe::FieldTable parameters() {
    using enum troupe::Unit;
    return {
        {{.name = "speed", .unit = meters_per_second, .fallback = 0.3, .min = 0, .text = "along the wall"},
         {.name = "distance", .unit = meters, .fallback = 0.5, .min = 0, .text = "from the wall"}}};
  }
  static FollowWall make(const troupe::Record& params) { return {params[0].number(), params[1].number()}; }

  struct Memory {
    std::uint32_t corners = 0;  // times that the wall ahead was near
    bool turning = false;
    TROUPE_FIELDS(corners, turning)
  };

  void operator()(Memory& memory, const troupe::Percept& percept, troupe::Random&,
                  troupe::Actions& actions) const {
    const std::span<const float> ranges = percept.ranges(0);  // m, from ahead to the left
    if (ranges.empty()) return;
    const float ahead = *std::ranges::min_element(ranges.first(ranges.size() / 2 + 1));
    const bool is_blocked = ahead < 1.2 * distance;
    memory.corners += is_blocked && !memory.turning;
    memory.turning = is_blocked;
    const double too_far = std::clamp(ranges.back() - distance, -0.3, 0.3);
    actions.command = is_blocked ? troupe::Command{0, 0, -1} : troupe::Command{speed, 0, 2 * too_far};
  }
};

}  // namespace

TROUPE_CONTROLLER("follow_wall", FollowWall)
