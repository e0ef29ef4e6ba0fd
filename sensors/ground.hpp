#pragma once

#include "base/color.hpp"
#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "engine/fields/description.hpp"
#include "engine/kinds/device_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace troupe::sensors {

/// The fields of the readings of a ground sensor, in order. Each field is an array with one entry per point
/// whose ground the sensor reads. Each comment begins with the type of the entries.
enum GroundField : std::size_t {
  k_ground_color,  ///< f32 [red green blue] per point, from 0 to 1
  k_ground_body,   ///< u32 per point: number (BodyId) of the body with this colour; 0: the floor
};

/// Returns the implementation of the sensor `ground`, which reads the colours of the ground below given
/// points of its robot. Words in backquotes are parameters of the sensor.
///
/// rule     The ground at a point is a part of another body, or the floor. A part is a piece of a body, such
///          as a plate or a wheel. Only parts that contain the point, seen from above, and whose top is at
///          most `height` (m) above z = 0 can be the ground. The part with the highest top is the ground. At
///          equal tops, it is the part of the body with the lower id; within one body, the part with the
///          lower number. If there is no such part, the ground is the floor, whose colour is `floor`.
/// ignores  The sensor ignores the parts of its own robot and of all bodies that move together with this
///          robot (one of the two carries the other, or a third body carries both).
/// zones    To make a coloured zone on the floor, give a model `"obstacle": false`, `"ranger_return": -1` and
///          a size of some millimetres in z. If the model has an LED, the sensor reads the colour of the LED.
/// edges    A point on the common border of two adjacent zones belongs to exactly one of them.
engine::DeviceKind ground_kind();

/// The parameter that determines which parts of bodies are ground (see ground_kind()). Devices that read or
/// change the ground include this struct in their own parameters.
struct GroundParams {
  double height = 0.05;  ///< a part is ground only if its top is at most this far above z = 0, m

  static constexpr void describe(engine::Description<GroundParams>& d) {
    using namespace engine::facts;
    d.member<&GroundParams::height>(
        "height", engine::Unit::meters, within(0, 10),
        "a part of a body is ground only if its top is at most this high above the floor");
  }
};

/// Finds the ground at a point of a world, by the rule that ground_kind() describes. Devices that read or
/// change the ground contain a Ground. They call collect() while the world is loaded, and then below() or
/// shown_below().
class Ground {
 public:
  /// The ground at a point: a part of a body, or the floor.
  struct Zone {
    double top = 0;          ///< height of the top surface, m, world frame
    BodyId body;             ///< the body; not valid for the floor
    std::uint32_t part = 0;  ///< number of the part in its body
    Color color;             ///< the colour of the part

    /// Whether this zone is above the zone `other` at a point that belongs to both. The zone with the higher
    /// top is above. At equal tops, it is the zone of the body with the lower id; within one body, the zone
    /// with the lower part number.
    bool is_above(const Zone& other) const;
  };

  /// Sets which parts can be ground, and the colour of the floor. params: only parts whose top is at most
  /// params.height (m) above z = 0 can be ground. floor: the colour where no such part covers the floor.
  explicit Ground(const GroundParams& params, const Color& floor = {})
      : height_(params.height), floor_(floor) {}

  /// The greatest height of the top of a part that can be ground, m.
  double height() const { return height_; }

  /// Collects those parts of static bodies that can be ground. A static body never moves, and has no devices
  /// and no controller. Call this function in the device's hook DeviceKind::bind_world, before the first call
  /// of below() or shown_below(). The engine calls this hook while it loads the world.
  void collect(const engine::WorldSpec& world);
  /// Returns the ground at a point (world frame, m), with the colours of the world file. If no part covers
  /// the point, the result has no valid body, a top of 0, and the colour of the floor. view: read access to
  /// the state of the world. own: row (index in the state tables) of the body that has the device. This body,
  /// and all bodies that move together with it (SensingView::same_tree()), are ignored.
  Zone below(const engine::SensingView& view, Row own, const Vec2& point) const;
  /// Returns the ground as below() does. If a device of the body, such as an LED, shows a colour on the part,
  /// the result has this colour instead of that of the world file. view: read access to the state of the
  /// world, including the states of devices.
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
