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

/// The fields of a radio's percepts, in order. The entries of arrays are the messages heard in the tick,
/// sorted by the id of the sender (those of one sender in the order of its radios); entries after the last
/// are 0.
enum RadioField : std::size_t {
  k_radio_count,     ///< u32: number of messages heard
  k_radio_lost,      ///< u32: messages that arrived but exceed `most_heard`, or are longer than `payload`
  k_radio_dropped,   ///< u32: messages dropped because of `drop_rate`
  k_radio_sender,    ///< u32 per message: BodyId of the sender
  k_radio_range,     ///< f32 per message, m: distance to the sending radio, on the ground
  k_radio_bearing,   ///< f32 per message, rad: bearing of the sending radio, frame of this radio
  k_radio_strength,  ///< f32 per message, dBm
  k_radio_quality,   ///< f32 per message: quality of the link, from 0 at its limit to 1 at no distance
  k_radio_length,    ///< u8 per message: bytes
  k_radio_payload,   ///< u8 [payload] per message; 0 after its last byte
};

/// The fields of a radio's command. The command stays in effect until it is changed.
enum RadioCommandField : std::size_t {
  k_radio_mode,   ///< u8: RadioMode
  k_radio_bytes,  ///< u8: length of the message
  k_radio_said,   ///< u8 [payload]: the message; 0 after its last byte
};
/// What a radio sends.
enum class RadioMode : std::uint8_t {
  as_world_says,  ///< as its parameters say: an empty message with `beacon`, else nothing
  says,           ///< the message in the command
  silent,         ///< nothing; it still hears messages
};

/// The bytes of a radio's longest message, for controllers that choose among devices.
inline std::size_t payload_of(const engine::DeviceKind::Prepared& radio) {
  return radio.percepts[k_radio_payload].columns / radio.percepts[k_radio_sender].columns;
}

/// The radio of a controller: reads the messages of this tick and sets the message to send.
///
///     sensors::RadioPort radio(percept.devices[0], actions.devices[0]);
///     for (std::size_t i = 0; i < radio.count(); ++i)
///       if (float heading; radio[i].read(heading)) ...
///     radio.say(my_heading);
class RadioPort {
 public:
  /// heard, asked: percepts and command of a device of the kind "radio" that the controller chose. The port
  /// is valid only during the decision.
  RadioPort(const engine::Readings& heard, std::byte* asked) : heard_(heard), asked_(asked) {}

  /// A message heard in this tick.
  struct Message {
    std::uint32_t sender = 0;               ///< id of the sending body
    float range = 0;                        ///< distance to the sending radio, m
    float bearing = 0;                      ///< bearing of the sending radio, rad, frame of this radio
    float strength = 0;                     ///< dBm
    float quality = 0;                      ///< from 0 at the limit of the link to 1 at no distance
    std::span<const std::uint8_t> payload;  ///< bytes; valid during the decision

    /// Reads the numbers that the payload consists of, one after another. Returns false and reads nothing if
    /// the payload has another length.
    template <class... T>
    bool read(T&... values) const {
      static_assert((std::is_arithmetic_v<T> && ...), "messages are made of numbers");
      if (payload.size() != (sizeof(T) + ... + 0)) return false;
      const std::uint8_t* from = payload.data();
      ((std::memcpy(&values, from, sizeof(T)), from += sizeof(T)), ...);
      return true;
    }
  };

  /// Number of messages heard in this tick.
  std::size_t count() const { return heard_.field<std::uint32_t>(k_radio_count)[0]; }
  /// The i-th message, in the order of the senders' ids; i must be below count().
  Message operator[](std::size_t i) const {
    const std::size_t length = heard_.field<std::uint8_t>(k_radio_length)[i];
    return {heard_.field<std::uint32_t>(k_radio_sender)[i],
            heard_.field<float>(k_radio_range)[i],
            heard_.field<float>(k_radio_bearing)[i],
            heard_.field<float>(k_radio_strength)[i],
            heard_.field<float>(k_radio_quality)[i],
            heard_.field<std::uint8_t>(k_radio_payload).subspan(i * capacity(), length)};
  }
  /// The bytes of the longest message.
  std::size_t capacity() const {
    return heard_.field<std::uint8_t>(k_radio_payload).size() /
           heard_.field<std::uint32_t>(k_radio_sender).size();
  }

  /// Sends the message in every tick from the next one on, until the command changes. Returns false and
  /// becomes silent if the message is longer than capacity().
  bool say_bytes(std::span<const std::uint8_t> message) const {
    be_silent();
    if (message.size() > capacity()) return false;
    auto* out = reinterpret_cast<std::uint8_t*>(asked_);
    out[k_radio_mode] = static_cast<std::uint8_t>(RadioMode::says);
    out[k_radio_bytes] = static_cast<std::uint8_t>(message.size());
    std::ranges::copy(message, out + k_radio_said);
    return true;
  }
  /// Sends numbers, one after another, like say_bytes(). Without numbers it sends an empty message.
  template <class... T>
  bool say(const T&... values) const {
    static_assert((std::is_arithmetic_v<T> && ...), "messages are made of numbers");
    std::array<std::uint8_t, (sizeof(T) + ... + 0)> bytes{};
    [[maybe_unused]] std::uint8_t* to = bytes.data();
    ((std::memcpy(to, &values, sizeof(T)), to += sizeof(T)), ...);
    return say_bytes(bytes);
  }
  /// Sends nothing from the next tick on, until the command changes. The radio still hears messages.
  void be_silent() const {
    std::memset(asked_, 0, k_radio_said + capacity());
    asked_[k_radio_mode] = static_cast<std::byte>(RadioMode::silent);
  }

 private:
  engine::Readings heard_;
  std::byte* asked_;
};

/// A radio with range and bearing: hears what other radios on its channel sent in the previous tick, and
/// where from.
///
/// heard     A message is heard if the sender is not in the listener's own tree and no farther away than its
///           own `range` and the listener's `hears`; if its strength, by the listener's law, is at least the
///           listener's sensitivity; and if nothing hides it
/// hides     With `walls` static geometry, with `bodies` other bodies, if rangers see it: an outline that the
///           straight line between the two radios crosses, at the height that the line has there. An outline
///           that the line only touches hides the sender if it is to the right of the line, seen from the
///           radio with the lower id. The result is the same in both directions
/// chance    each message is dropped with probability `drop_rate`, by (seed, radio, tick, sender, listener)
/// limits    of the messages that then arrive, those longer than the listener's payload are lost; of the
///           others the `most_heard` nearest are heard, at equal ranges those of the lower sender, and the
///           rest are lost
/// order     by the id of the sender
///
/// strength  dBm: the power of the sender minus the loss of the law, and minus `wall_loss_dB` for each wall
///           on the way if `walls` is weaken. With f in Hz, d in m, c the speed of light:
///             disc          0
///             friis         20 log10(4 pi d f / c)                 (free space: Friis, 1946)
///             itu_indoor    20 log10(f / MHz) + N log10(d) - 28    (ITU-R P.1238, one floor)
///             log_distance  20 log10(4 pi f / c) + 10 n log10(d)   (Rappaport, 1 m as reference)
///           and no loss is below 0
/// quality   1 - loss / (power - sensitivity); with `disc` at most 1 - range / limit
/// edges     a link at exactly its limit exists; between radios at one place the bearing is 0
engine::DeviceKind radio_kind();

}  // namespace troupe::sensors
