#pragma once

#include "base/result.hpp"
#include "engine/fields.hpp"
#include "engine/frame.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace troupe {

/// One number per body from its state: a column of a field of a component.
struct ChosenValue {
  std::string component;   ///< "velocity", "wander/0": StateTable::component()
  std::string field;       ///< field of the component
  std::size_t column = 0;  ///< column of the field
  std::string text;        ///< label with unit: "velocity.x (m/s)"
};

/// The parts of a frame that are requested in addition to bodies.
struct FrameWishes {
  bool scans = false;                ///< Frame::scans and ranges
  bool sights = false;               ///< Frame::sights
  bool blobs = false;                ///< Frame::blobs
  bool grips = false;                ///< Frame::grips
  bool links = false;                ///< Frame::links
  bool charges = false;              ///< Frame::charges
  bool names = false;                ///< Frame::names
  std::optional<ChosenValue> value;  ///< Frame::values
};

/// A state to draw: the current one of a simulation, or one of a recording.
class PictureSource {
 public:
  virtual ~PictureSource() = default;

  /// The file name in errors.
  virtual std::string file() const = 0;
  /// The file of the world, for labels.
  virtual std::string world() const { return file(); }
  virtual std::uint64_t seed() const = 0;  ///< seed of the world
  virtual double tick_s() const = 0;       ///< length of a tick, s
  /// The `window` of the world; null if it has none.
  virtual const engine::Record* window() const = 0;
  virtual engine::FrameScene scene() const = 0;  ///< the static scene
  /// The id of the body of this name; empty if there is none.
  virtual std::optional<std::uint32_t> find_body(std::string_view name) const = 0;

  /// Resolves a name of a value for FrameWishes. The error names the unknown part and lists the known ones.
  virtual Result<ChosenValue> find_value(const std::string& name) const = 0;
  /// Whether this source has all requested parts; else an error that names a missing one, and why.
  virtual Result<> check(const FrameWishes& wishes) const = 0;

  // The current state.
  virtual double time_s() const = 0;             ///< world time, s
  virtual std::uint64_t state_hash() const = 0;  ///< docs/determinism.md
  /// The mobile bodies, and the requested parts, without entries for bodies that lack them.
  virtual engine::Frame frame(const FrameWishes& wishes) const = 0;
};

}  // namespace troupe
