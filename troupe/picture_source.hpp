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

/// One number a body out of its state: a field of the components of one name.
struct ChosenValue {
  std::string component;   ///< "velocity", "wander/0": StateTable::component()
  std::string field;       ///< of the component
  std::size_t column = 0;  ///< of the field
  std::string text;        ///< for people, with its unit: "velocity.x (m/s)"
};

/// What a frame is to hold beside bodies.
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

/// What pictures are made of: a simulation where it stands, or a recording.
class PictureSource {
 public:
  virtual ~PictureSource() = default;

  /// What errors call it.
  virtual std::string file() const = 0;
  /// The file of the world, for people.
  virtual std::string world() const { return file(); }
  virtual std::uint64_t seed() const = 0;  ///< of the world
  virtual double tick_s() const = 0;       ///< length of a tick
  /// The `window` of the world; null where it has none.
  virtual const engine::Record* window() const = 0;
  virtual engine::FrameScene scene() const = 0;  ///< what never changes
  /// The id of the body of this name; nothing where there is none.
  virtual std::optional<std::uint32_t> find_body(std::string_view name) const = 0;

  /// The value of that name, for FrameWishes. Where there is no such thing the error says so, and what there
  /// is.
  virtual Result<ChosenValue> find_value(const std::string& name) const = 0;
  /// Whether all of the wishes can be had here; else which cannot, and why.
  virtual Result<> check(const FrameWishes& wishes) const = 0;

  // The state where it stands.
  virtual double time_s() const = 0;             ///< world time
  virtual std::uint64_t state_hash() const = 0;  ///< docs/determinism.md
  /// What moves, and of the rest what is wished for: bodies that have no such thing are left out.
  virtual engine::Frame frame(const FrameWishes& wishes) const = 0;
};

}  // namespace troupe
