#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "engine/description.hpp"
#include "engine/kinds.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace troupe::sensors {

/// Fields of a ground sensor's percepts, in their order.
enum GroundField : std::size_t {
  k_ground_color,  ///< f32 [red green blue] for each point, from 0 to 1
  k_ground_body,   ///< u32 for each point: BodyId of what has this colour; 0: the floor
};

/// A ground sensor: the colours below given points of its robot. The ground is what lies flat on the floor:
/// of the parts of other bodies that hold the point and whose top is no higher than `height`, the one with
/// the highest top, of equal ones that of the lower (body, part); where there is none, the floor.
///
/// zones  are models of the world, with `"obstacle": false` and `"ranger_return": -1` and a size of some
///        millimetres in z; the colour of one that carries an LED is that of the LED
/// edges  of two zones that share a border a point on it lies in one
engine::DeviceKind ground_kind();

/// What of a world is ground: a part of the parameters of devices that look at it or change it.
struct GroundParams {
  double height = 0.05;

  static constexpr void describe(engine::Description<GroundParams>& d) {
    using namespace engine::facts;
    d.member<&GroundParams::height>("height", engine::Unit::meters, within(0, 10),
                                    "parts with a higher top are not ground");
  }
};

/// The ground of a world, for devices that look at it or change it.
class Ground {
 public:
  /// What lies at a point.
  struct Zone {
    double top = 0;          ///< m above the floor
    BodyId body;             ///< whose it is; not valid: the floor's
    std::uint32_t part = 0;  ///< of the body
    Color color;             ///< of the part

    /// Whether it hides the other one.
    bool is_above(const Zone& other) const;
  };

  /// floor: the colour where nothing lies.
  explicit Ground(const GroundParams& params, const Color& floor = {})
      : height_(params.height), floor_(floor) {}

  /// Once, before the others: collects what lies flat and never moves. Of DeviceKind::look.
  void look(const engine::WorldSpec& world);
  /// What is seen at a point, world frame, m, by a device of the row `own`, of whose tree nothing counts. Not
  /// valid, and of the floor's colour: there is nothing. Colours that devices show are to be asked for in the
  /// sense phase alone: in others they change.
  Zone below(const engine::World& world, Row own, const Vec2& point, bool with_shown_colors) const;

 private:
  struct Fixed;  // the flat parts of bodies that never move

  double height_;
  Color floor_;
  std::shared_ptr<const Fixed> fixed_;
};

}  // namespace troupe::sensors
