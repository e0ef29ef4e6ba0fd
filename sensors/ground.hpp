#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "engine/fields/description.hpp"
#include "engine/kinds/kinds.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace troupe::sensors {

/// The fields of a ground sensor's readings, in order. Each field is an array with one entry per point that
/// the sensor looks at; its comment begins with the type of the entries.
enum GroundField : std::size_t {
  k_ground_color,  ///< f32 [red green blue] per point, from 0 to 1
  k_ground_body,   ///< u32 per point: number (BodyId) of the body with this colour; 0: the floor
};

/// Returns the implementation of the sensor `ground`, which reads the colours of the ground below given
/// points of its robot. A part of another body is the ground at a point if the part contains the point, seen
/// from above, and if its top is not above the parameter `height`. Of several such parts, the part with the
/// highest top counts; at equal tops, the part of the body with the lower id, and within one body the part
/// with the lower number. If there is no such part, the ground is the floor, whose colour is the parameter
/// `floor`. The robot itself and all bodies that move with it (one carries the other, or a third body carries
/// both) are ignored.
///
/// zones  Coloured zones on the ground are models with `"obstacle": false`, `"ranger_return": -1` and a size
///        of some millimetres in z. A zone with an LED has the colour of the LED.
/// edges  A point on the common border of two adjacent zones is in exactly one of them.
engine::DeviceKind ground_kind();

/// The parameter that says which parts of bodies are ground. Devices that read or change the ground include
/// this struct in their own parameters.
struct GroundParams {
  double height = 0.05;  ///< a part is ground only if its top is at most this far above z = 0, m

  static constexpr void describe(engine::Description<GroundParams>& d) {
    using namespace engine::facts;
    d.member<&GroundParams::height>(
        "height", engine::Unit::meters, within(0, 10),
        "a part of a body is ground only if its top is at most this high above the floor");
  }
};

/// The ground of a world, for devices that read it or change it.
class Ground {
 public:
  /// The ground at a point: a part of a body, or the floor.
  struct Zone {
    double top = 0;          ///< height of the top surface, m, world frame
    BodyId body;             ///< the body; not valid for the floor
    std::uint32_t part = 0;  ///< number of the part in its body
    Color color;             ///< the colour of the part

    /// Whether this zone hides the zone `other` at a point that both contain. The zone with the higher top
    /// hides the other; at equal tops, the zone of the body with the lower id does; within one body, the zone
    /// with the lower part number.
    bool is_above(const Zone& other) const;
  };

  /// params: the greatest height of the tops of parts that are ground. floor: the colour of the floor, which
  /// is the ground where no part of a body covers it.
  explicit Ground(const GroundParams& params, const Color& floor = {})
      : height_(params.height), floor_(floor) {}

  /// Collects the parts of static bodies that are ground. Must be called in the device's hook
  /// DeviceKind::bind_world, which the engine calls while it loads the world, and before the first call of
  /// below() or shown_below().
  void collect(const engine::WorldSpec& world);
  /// Returns the ground at a point (world frame, m) for a device on the body with the row (index in the
  /// state tables) `own`. This body, and all bodies that move with it (SensingView::same_tree()), are
  /// ignored. If no part covers the point, the result has no valid body, a top of 0, and the colour of the
  /// floor. Colours are those of the world file. view: read access to the state of the world.
  Zone below(const engine::SensingView& view, Row own, const Vec2& point) const;
  /// Like below(), but a part with a device that shows a colour, such as an LED, has the colour that the
  /// device shows. view: read access to the state of the world, including the states of devices.
  Zone shown_below(const engine::CommittedView& view, Row own, const Vec2& point) const;

 private:
  struct Fixed;  // the parts of static bodies that are ground
  template <class View>
  Zone find(const View& view, Row own, const Vec2& point) const;

  double height_;
  Color floor_;
  std::shared_ptr<const Fixed> fixed_;
};

}  // namespace troupe::sensors
