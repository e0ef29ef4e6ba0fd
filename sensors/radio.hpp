#pragma once

#include "engine/kinds.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace troupe::sensors {

/// Fields of a radio's state, in their order: entries of the arrays are the messages that it heard in the
/// tick, by the id of the sender (of one with several radios in their order); those behind the last are 0.
enum RadioField : std::size_t {
  k_radio_count,     ///< u32: messages heard
  k_radio_lost,      ///< u32: that arrived beside them: beyond `most_heard`, or longer than `payload`
  k_radio_dropped,   ///< u32: that would have arrived, but for `drop_rate`
  k_radio_sender,    ///< u32 each: BodyId of who said it
  k_radio_range,     ///< f32 each, m: to the sender's radio, on the ground
  k_radio_bearing,   ///< f32 each, rad: of the sender's radio, in the frame of this one
  k_radio_strength,  ///< f32 each, dBm
  k_radio_quality,   ///< f32 each: how much of the link is left, from 0 at its limit to 1 at no distance
  k_radio_length,    ///< u8 each: bytes
  k_radio_payload,   ///< u8 [payload] each; those behind the message's last are 0
};

/// Fields of what is asked of a radio. It stays so until it is asked otherwise.
enum RadioCommandField : std::size_t {
  k_radio_mode,   ///< u8: RadioMode
  k_radio_bytes,  ///< u8: length of the message
  k_radio_said,   ///< u8 [payload]: the message; 0 behind its last byte
};
/// What a radio is asked to do.
enum class RadioMode : std::uint8_t {
  as_world_says,  ///< what its parameters have it say, if anything
  says,           ///< the message that it was asked to say
  silent,         ///< it says nothing, and hears all the same
};

/// Bytes of the longest message of a radio, for controllers that choose among devices.
inline std::size_t payload_of(const engine::DeviceKind::Prepared& radio) {
  return radio.percepts[k_radio_payload].columns / radio.percepts[k_radio_sender].columns;
}

/// A radio as its controller has it: what it heard in this tick, and what it is to say from now on.
///
///     sensors::RadioPort radio(percept.devices[0], actions.devices[0]);
///     for (std::size_t i = 0; i < radio.count(); ++i)
///       if (float heading; radio[i].read(heading)) ...
///     radio.say(my_heading);
class RadioPort {
 public:
  /// heard, asked: of a device of the kind "radio" that the controller chose. The port is no longer than the
  /// decision.
  RadioPort(const engine::Readings& heard, std::byte* asked) : heard_(heard), asked_(asked) {}

  /// A message that was heard in this tick.
  struct Message {
    std::uint32_t sender = 0;               ///< id of the body that said it
    float range = 0;                        ///< m
    float bearing = 0;                      ///< rad, frame of the radio
    float strength = 0;                     ///< dBm
    float quality = 0;                      ///< from 0 at the limit of the link to 1
    std::span<const std::uint8_t> payload;  ///< its bytes; valid during the decision

    /// The numbers that the payload is made of, one behind another. False, and nothing is read, where it has
    /// another length.
    template <class... T>
    bool read(T&... values) const {
      static_assert((std::is_arithmetic_v<T> && ...), "messages are made of numbers");
      if (payload.size() != (sizeof(T) + ... + 0)) return false;
      const std::uint8_t* from = payload.data();
      ((std::memcpy(&values, from, sizeof(T)), from += sizeof(T)), ...);
      return true;
    }
  };

  /// Messages heard in this tick.
  std::size_t count() const { return heard_.field<std::uint32_t>(k_radio_count)[0]; }
  /// The i-th of them, by the sender's id; i below count().
  Message operator[](std::size_t i) const {
    const std::size_t length = heard_.field<std::uint8_t>(k_radio_length)[i];
    return {heard_.field<std::uint32_t>(k_radio_sender)[i],
            heard_.field<float>(k_radio_range)[i],
            heard_.field<float>(k_radio_bearing)[i],
            heard_.field<float>(k_radio_strength)[i],
            heard_.field<float>(k_radio_quality)[i],
            heard_.field<std::uint8_t>(k_radio_payload).subspan(i * capacity(), length)};
  }
  /// Bytes of the longest message.
  std::size_t capacity() const {
    return heard_.field<std::uint8_t>(k_radio_payload).size() /
           heard_.field<std::uint32_t>(k_radio_sender).size();
  }

  /// From the next tick on, in every tick until it is asked otherwise. False, and it is silent, where the
  /// message is longer than its payload.
  bool say_bytes(std::span<const std::uint8_t> message) const {
    be_silent();
    if (message.size() > capacity()) return false;
    auto* out = reinterpret_cast<std::uint8_t*>(asked_);
    out[k_radio_mode] = static_cast<std::uint8_t>(RadioMode::says);
    out[k_radio_bytes] = static_cast<std::uint8_t>(message.size());
    std::ranges::copy(message, out + k_radio_said);
    return true;
  }
  /// The same of numbers, one behind another; of none: only that it is there.
  template <class... T>
  bool say(const T&... values) const {
    static_assert((std::is_arithmetic_v<T> && ...), "messages are made of numbers");
    std::array<std::uint8_t, (sizeof(T) + ... + 0)> bytes{};
    [[maybe_unused]] std::uint8_t* to = bytes.data();
    ((std::memcpy(to, &values, sizeof(T)), to += sizeof(T)), ...);
    return say_bytes(bytes);
  }
  /// From the next tick on, until it is asked otherwise; it hears all the same.
  void be_silent() const {
    std::memset(asked_, 0, k_radio_said + capacity());
    asked_[k_radio_mode] = static_cast<std::byte>(RadioMode::silent);
  }

 private:
  engine::Readings heard_;
  std::byte* asked_;
};

/// A radio that tells where what it hears comes from: what others on its channel said in the tick before,
/// with range and bearing.
///
/// heard     who says something, is not of its own tree, and is no farther than the sender's `range` and the
///           listener's `hears`; whose strength, by the listener's law, is no less than its sensitivity; and
///           whom nothing hides
/// hides     with `walls` the static scene, with `bodies` other bodies, where rangers see it: an outline that
///           the straight line between the two radios crosses, at the height that the line has there. What a
///           line only touches hides it if it lies on its right, seen from the lower id. Both directions have
///           one answer
/// chance    each message is dropped with probability `drop_rate`, by (seed, radio, tick, sender, listener)
/// limits    of what then arrives, messages longer than the listener's payload are lost; of the others the
///           `most_heard` nearest are heard, of equal ranges those of the lower sender, and the rest is lost
/// order     by the sender's id
/// strength  dBm: the sender's power, less the loss of the law and `wall_loss_dB` for each wall on the way
///           where `walls` weaken. With f in Hz, d in m, c the speed of light:
///             disc          0
///             friis         20 log10(4 pi d f / c)                 (free space: Friis, 1946)
///             itu_indoor    20 log10(f / MHz) + N log10(d) - 28    (ITU-R P.1238, one floor)
///             log_distance  20 log10(4 pi f / c) + 10 n log10(d)   (Rappaport, 1 m as reference)
///           and none is below 0
/// quality   1 - loss / (power - sensitivity); with `disc` no more than 1 - range / limit
/// edges     a link is there at exactly its limit; of radios in one place the bearing is 0
engine::DeviceKind radio_kind();

}  // namespace troupe::sensors
