#pragma once

#include "base/result.hpp"
#include "engine/fields/fields.hpp"
#include "engine/observing/frame.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace troupe {

/// The place of a number in the state of a body: component, field and column. Troupe stores the state of the
/// bodies in tables, called components. A component has named fields, and a field has one or more columns.
struct ChosenValue {
  std::string component;   ///< name of the component: "velocity", "wander/0" (StateTable::component())
  std::string field;       ///< name of the field in the component
  std::size_t column = 0;  ///< index of the column in the field
  std::string text;        ///< label with unit: "velocity.x (m/s)"
};

/// The data that a caller requests from a PictureSource, in addition to the poses of bodies. The data are
/// members of engine::Frame, the struct with all that a viewer needs to draw the world at one tick (time
/// step), and of engine::FrameScene, which has the constant data.
struct FrameWishes {
  bool scans = false;                ///< readings of range sensors: Frame::scans and Frame::ranges
  bool sights = false;               ///< lines to detected markers: Frame::sights
  bool blobs = false;                ///< detected regions of one colour: Frame::blobs
  bool grips = false;                ///< light beams of grippers, lines to held bodies: Frame::grips
  bool links = false;                ///< lines to carried bodies: Frame::links
  bool charges = false;              ///< charges of energy stores: Frame::charges
  bool names = false;                ///< names of bodies: Frame::names
  std::optional<ChosenValue> value;  ///< the value by which bodies are coloured: Frame::values; empty: none
  bool tiles = false;                ///< tiles of the spatial index: FrameScene::tile_m
  bool cells = false;                ///< cells of the spatial index: FrameScene::cell_m
};

/// A state to draw: the current state of a simulation, or a frame of a recording. A frame of a recording is
/// the recorded state at one tick (time step).
class PictureSource {
 public:
  virtual ~PictureSource() = default;

  /// Name of the file that is drawn, a world file or a recording, for error messages.
  virtual std::string file() const = 0;
  /// Name of the world file, for labels in pictures.
  virtual std::string world() const { return file(); }
  virtual std::uint64_t seed() const = 0;  ///< seed of the world
  virtual double tick_s() const = 0;       ///< length of a tick, s
  /// The entry `window` of the world file, which describes a view of the world; null if the file has none.
  virtual const engine::Record* window() const = 0;
  virtual engine::FrameScene scene() const = 0;  ///< static bodies, shapes, and other constant data
  /// The id of the body of this name; empty if there is no such body.
  virtual std::optional<std::uint32_t> find_body(std::string_view name) const = 0;

  /// Finds the value of this name (COMPONENT.FIELD or COMPONENT.FIELD.COLUMN), for FrameWishes::value. If
  /// there is no such value, the error lists the known values; if only the column does not exist, the error
  /// states the columns of the field.
  virtual Result<ChosenValue> find_value(const std::string& name) const = 0;
  /// Returns success if this source has the data of all members that `wishes` request, else an error that
  /// states which data are missing and why.
  virtual Result<> check(const FrameWishes& wishes) const = 0;

  // The state to draw.
  virtual double time_s() const = 0;             ///< simulated time, s
  virtual std::uint64_t state_hash() const = 0;  ///< hash of the whole state (docs/determinism.md)
  /// Returns the poses of the mobile bodies (those that are in the world and not static), and the members of
  /// engine::Frame that `wishes` request. Some of these members, such as Frame::charges, have one number per
  /// mobile body; the number is NaN for a body that lacks it. The other members, such as Frame::scans, have
  /// no entry for a body that lacks the data.
  virtual engine::Frame frame(const FrameWishes& wishes) const = 0;
};

}  // namespace troupe
