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

/// The fields of a ground sensor's percepts, in order.
enum GroundField : std::size_t {
  k_ground_color,  ///< f32 [red green blue] per point, from 0 to 1
  k_ground_body,   ///< u32 per point: BodyId of the body with this colour; 0: the floor
};

/// A ground sensor: reads the colours below given points of its robot. The ground at a point is the part of
/// another body that contains the point and has the highest top not above `height`; of several such parts the
/// lower (body, part). If there is none, it is the floor.
///
/// zones  are models of the world, with `"obstacle": false` and `"ranger_return": -1` and a size of some
///        millimetres in z; a zone with an LED has the colour of the LED
/// edges  a point on the common border of two zones is in exactly one of them
engine::DeviceKind ground_kind();

/// The parameter that defines the ground: a part of the parameters of devices that read it or change it.
struct GroundParams {
  double height = 0.05;

  static constexpr void describe(engine::Description<GroundParams>& d) {
    using namespace engine::facts;
    d.member<&GroundParams::height>(
        "height", engine::Unit::meters, within(0, 10),
        "parts of bodies with a top higher than this above the floor are not ground");
  }
};

/// The ground of a world, for devices that read it or change it.
class Ground {
 public:
  /// The part of a body, or the floor, at a point.
  struct Zone {
    double top = 0;          ///< top, m above the floor
    BodyId body;             ///< the body; not valid for the floor
    std::uint32_t part = 0;  ///< the part of the body
    Color color;             ///< the colour of the part

    /// Whether it hides the other one.
    bool is_above(const Zone& other) const;
  };

  /// floor: the colour of the bare floor
  explicit Ground(const GroundParams& params, const Color& floor = {})
      : height_(params.height), floor_(floor) {}

  /// Collects the flat static parts. Call it once, from DeviceKind::bind_world, before below().
  void collect(const engine::WorldSpec& world);
  /// The ground at a point (world frame, m) for a device of the row `own`; ignores all bodies of its tree. On
  /// the bare floor the body is not valid and the colour that of the floor. with_shown_colors: use the
  /// colours that devices show; only allowed in the sense phase, because they change in other phases
  Zone below(const engine::World& world, Row own, const Vec2& point, bool with_shown_colors) const;

 private:
  struct Fixed;  // the flat parts of static bodies

  double height_;
  Color floor_;
  std::shared_ptr<const Fixed> fixed_;
};

}  // namespace troupe::sensors
