#pragma once

#include "engine/kinds/device_kind.hpp"
#include "engine/kinds/percept.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace troupe::sensors {

/// The fields of the readings of a radio, in order. Each comment begins with the type of the field. Words in
/// backquotes are parameters of the radio. A field "per message" is an array of `most_heard` entries, one for
/// each message heard in the tick (time step). The messages are sorted by the id of the sending body. If one
/// body has several radios, their messages are in the order of these radios. Entries after the last message
/// are 0.
enum RadioField : std::size_t {
  k_radio_count,     ///< u32: number of messages heard
  k_radio_lost,      ///< u32: number of messages that arrived but were too many or too long to be heard
  k_radio_dropped,   ///< u32: number of messages dropped at random because of `drop_rate`
  k_radio_sender,    ///< u32 per message: number (BodyId) of the body that sent it
  k_radio_range,     ///< f32 per message, m: horizontal distance to the sending radio
  k_radio_bearing,   ///< f32 per message, rad: bearing of the sending radio, frame of the hearing radio
  k_radio_strength,  ///< f32 per message: strength with which it arrived, dBm
  k_radio_quality,   ///< f32 per message: quality of the link, 0 (worst) to 1, see radio_kind()
  k_radio_length,    ///< u8 per message: its length, bytes
  k_radio_payload,   ///< u8 [payload] per message: its bytes; 0 after its last byte
};

/// The offsets, in bytes, of the fields in the command of a radio. With this command, a controller sets the
/// message to send. The command stays in effect until a controller changes it.
enum RadioCommandField : std::size_t {
  k_radio_mode,   ///< u8: whether the radio sends, a RadioMode
  k_radio_bytes,  ///< u8: length of the message, bytes
  k_radio_said,   ///< u8 [payload]: the bytes of the message; 0 after its last byte
};
/// What a radio sends.
enum class RadioMode : std::uint8_t {
  as_world_says,  ///< an empty message if the radio's parameter `beacon` is true, else nothing
  says,           ///< the message in the command
  silent,         ///< nothing; it still hears messages
};

/// Returns the length in bytes of the longest message that a radio can send or hear: its parameter `payload`.
/// Controllers use this function while a world is loaded, for example to choose a radio whose messages are
/// long enough. radio: the data that the engine prepared from the parameters of the radio.
inline std::size_t payload_of(const engine::DeviceKind::Prepared& radio) {
  return radio.percepts[k_radio_payload].columns / radio.percepts[k_radio_sender].columns;
}

/// The interface of a controller to a radio: reads the messages heard in this tick (time step) and sets the
/// message to send. In the example, percept and actions are arguments of the controller, and its first
/// device, devices[0], is the radio.
///
///     sensors::RadioPort radio(percept.devices[0], actions.devices[0]);
///     for (std::size_t i = 0; i < radio.count(); ++i)
///       if (float heading; radio[i].read(heading)) ...
///     radio.say(my_heading);
class RadioPort {
 public:
  /// Connects to a device of the kind `radio`. heard: the readings of the device. asked: the bytes of the
  /// command to the same device, which say(), say_bytes() and be_silent() overwrite; they throw
  /// std::logic_error if there are too few. Both arguments, and so the port, are valid only until the
  /// controller returns.
  RadioPort(const engine::Readings& heard, std::span<std::byte> asked) : heard_(heard), asked_(asked) {}
  /// Connects in the same way, for controllers of batches: asked is DecideBatch::device_command() of the
  /// device, and its size is not checked. Null: the port can only read.
  RadioPort(const engine::Readings& heard, std::byte* asked)
      : heard_(heard), asked_(asked, asked == nullptr ? 0 : k_radio_said + capacity()) {}

  /// A message heard in this tick.
  struct Message {
    std::uint32_t sender = 0;               ///< id of the sending body
    float range = 0;                        ///< horizontal distance to the sending radio, m
    float bearing = 0;                      ///< bearing of the sending radio, rad, frame of the hearing radio
    float strength = 0;                     ///< strength with which it arrived, dBm
    float quality = 0;                      ///< quality of the link, 0 (worst) to 1, see radio_kind()
    std::span<const std::uint8_t> payload;  ///< the bytes of the message; valid until the controller returns

    /// Copies the bytes of the payload to `values`, one number after another: the inverse of say(). If the
    /// length of the payload is not the sum of the sizes of `values`, returns false and changes no number.
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
  std::size_t count() const {
    const std::span<const std::uint32_t> senders = heard_.field<std::uint32_t>(k_radio_sender);
    return std::min<std::size_t>(heard_.field<std::uint32_t>(k_radio_count)[0], senders.size());
  }
  /// Returns the i-th message of this tick. The messages are sorted by the id of the sending body. `i` must
  /// be below count(), which is not checked.
  Message operator[](std::size_t i) const {
    const std::size_t length =
        std::min<std::size_t>(heard_.field<std::uint8_t>(k_radio_length)[i], capacity());
    return {heard_.field<std::uint32_t>(k_radio_sender)[i],
            heard_.field<float>(k_radio_range)[i],
            heard_.field<float>(k_radio_bearing)[i],
            heard_.field<float>(k_radio_strength)[i],
            heard_.field<float>(k_radio_quality)[i],
            heard_.field<std::uint8_t>(k_radio_payload).subspan(i * capacity(), length)};
  }
  /// The length in bytes of the longest message that the radio can send or hear.
  std::size_t capacity() const {
    return heard_.field<std::uint8_t>(k_radio_payload).size() /
           heard_.field<std::uint32_t>(k_radio_sender).size();
  }

  /// Makes the radio send the message in every tick from the next one on, until the command changes. If the
  /// message is longer than capacity(), makes the radio silent, as be_silent() does, and returns false;
  /// otherwise returns true.
  bool say_bytes(std::span<const std::uint8_t> message) const {
    be_silent();
    if (message.size() > capacity()) return false;
    auto* out = reinterpret_cast<std::uint8_t*>(asked_.data());
    out[k_radio_mode] = static_cast<std::uint8_t>(RadioMode::says);
    out[k_radio_bytes] = static_cast<std::uint8_t>(message.size());
    std::ranges::copy(message, out + k_radio_said);
    return true;
  }
  /// Makes the radio send a message that consists of the bytes of `values`, one number after another. Without
  /// `values`, the message is empty. Apart from this, it works as say_bytes(): it returns false, and makes
  /// the radio silent, if the message is longer than capacity().
  template <class... T>
  bool say(const T&... values) const {
    static_assert((std::is_arithmetic_v<T> && ...), "messages are made of numbers");
    std::array<std::uint8_t, (sizeof(T) + ... + 0)> bytes{};
    [[maybe_unused]] std::uint8_t* to = bytes.data();
    ((std::memcpy(to, &values, sizeof(T)), to += sizeof(T)), ...);
    return say_bytes(bytes);
  }
  /// Makes the radio send nothing from the next tick on, until the command changes. The radio still hears
  /// messages.
  void be_silent() const {
    const std::size_t bytes = k_radio_said + capacity();
    if (asked_.size() < bytes)
      throw std::logic_error("commands a radio, whose command has " + std::to_string(bytes) +
                             " bytes, through a command of " + std::to_string(asked_.size()) +
                             " bytes: give RadioPort the readings and the command of the same radio");
    std::memset(asked_.data(), 0, bytes);
    asked_[k_radio_mode] = static_cast<std::byte>(RadioMode::silent);
  }

 private:
  engine::Readings heard_;
  std::span<std::byte> asked_;
};

/// Returns the implementation of the sensor `radio`. In each tick (time step), a radio hears the messages
/// that other radios on its channel (a parameter) sent in the previous tick, with the range and the bearing
/// of each sender. Below, the listener is the radio that hears a message, and the sender is the radio that
/// sent it. Words in backquotes are parameters of radios.
///
/// arrives   A message arrives if all these conditions hold. The horizontal distance of the radios is at most
///           the sender's `range`. The distance is also at most the listener's `hears` or, if `hears` is 0,
///           the listener's `range`. The strength of the message is at least the listener's
///           `sensitivity_dBm`. Nothing hides the sender. The body of the sender is neither the body of the
///           listener nor a body that moves together with it (one of the two carries the other, or a third
///           body carries both).
/// hides     An outline hides the sender if the straight line between the two radios crosses it at a height
///           within its z interval, and if range sensors detect the outline (ranger_return >= 0). Static
///           geometry (walls and other bodies that never move) hides senders if the listener's `walls` is
///           "block". Other bodies hide senders if the listener's `bodies` is "block". The bodies of the two
///           radios never hide the sender. Neither do bodies that move together with one of these two.
/// touches   An outline that the line only touches hides the sender if the outline is to the right of the
///           line. For this rule, the line is directed from the radio on the body with the lower id to the
///           other radio. The result is therefore the same in both directions.
/// drops     Each message that arrives is dropped with the probability `drop_rate` of the listener. The
///           random number depends only on the seed, the name of the listener's radio, the tick, the ids of
///           the two bodies, and which of the radios of the sender's body on the channel sends.
/// limits    A message that arrives and is not dropped is lost if it is longer than the listener's `payload`.
///           If more than `most_heard` messages remain, the listener hears those of the nearest senders, and
///           the others are lost. At equal distances, senders on bodies with lower ids are heard first.
///
/// strength  The strength in dBm is the sender's `power_dBm` minus the loss in dB. The loss depends on the
///           listener's `law`, on the frequency f in Hz (from the listener's `frequency_GHz`), on the
///           horizontal distance d in m, and on the speed of light c in m/s:
///             disc          0
///             friis         20 log10(4 pi d f / c)                 (free space: Friis, 1946)
///             itu_indoor    20 log10(f / MHz) + N log10(d) - 28    (ITU-R P.1238, one floor)
///             log_distance  20 log10(4 pi f / c) + 10 n log10(d)   (Rappaport, 1 m as reference)
///           N is the listener's `power_loss_coefficient`, and n is its `path_loss_exponent`. A negative
///           value counts as a loss of 0. If the listener's `walls` is "weaken", each wall between the radios
///           then adds `wall_loss_dB` to the loss.
/// quality   The quality of a link is 1 - loss / (`power_dBm` of the sender - `sensitivity_dBm` of the
///           listener), but at least 0. With the law `disc`, it is also at most 1 - distance / limit. Here,
///           limit is the largest distance at which the listener hears this sender (see "arrives").
/// edges     Radios at exactly the largest distance hear each other. Between radios at the same place, the
///           bearing is 0.
engine::DeviceKind radio_kind();

}  // namespace troupe::sensors
