#pragma once

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
  std::string component;
  std::string field;
  std::size_t column = 0;
  std::string text;  ///< for people, with its unit: "velocity.x (m/s)"
};

/// What a frame is to hold beside bodies.
struct FrameWishes {
  bool scans = false;
  bool sights = false;
  bool blobs = false;
  bool grips = false;
  bool links = false;
  bool charges = false;
  bool names = false;
  std::optional<ChosenValue> value;
};

/// What pictures are made of: a simulation where it stands, or a recording.
class PictureSource {
 public:
  virtual ~PictureSource() = default;

  /// For errors.
  virtual std::string file() const = 0;
  /// The file of the world, for people.
  virtual std::string world() const { return file(); }
  virtual std::uint64_t seed() const = 0;
  virtual double tick_s() const = 0;
  /// The `window` of the world; null where it has none.
  virtual const engine::Record* window() const = 0;
  virtual engine::FrameScene scene() const = 0;
  virtual std::optional<std::uint32_t> find_body(std::string_view name) const = 0;

  /// The value of that name, for FrameWishes. Where there is no such thing `fault` says so, and what there
  /// is.
  virtual std::optional<ChosenValue> find_value(const std::string& name, std::string& fault) const = 0;
  /// What of the wishes cannot be had here, and why, as the end of an error; empty: all can.
  virtual std::string missing(const FrameWishes& wishes) const = 0;

  // The state where it stands.
  virtual double time_s() const = 0;
  virtual std::uint64_t state_hash() const = 0;
  virtual engine::Frame frame(const FrameWishes& wishes) const = 0;
};

}  // namespace troupe
