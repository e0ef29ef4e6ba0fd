#pragma once

#include "engine/world/world.hpp"
#include "worldio/results/replay_header.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace troupe::live {

/// The state of a running world at one instant, as the server of a live view sends it to its clients. Clients
/// are the web pages and programs that are connected to the server. Each client has a number. The page shows
/// all bodies of the world except static ones. They are called shown bodies here.
///
/// The thread that steps the world fills a picture. The thread of the server encodes it.
struct Picture {
  std::uint64_t number = 0;  ///< number of the picture, counted from 1
  /// Members of a JSON object, without its braces, for all clients (docs/live-protocol.md).
  std::string state;
  /// More members of the JSON object for single clients, for example the state of the body that a client
  /// inspects. The keys of the map are numbers of clients. A client without an entry receives only `state`.
  std::map<std::uint64_t, std::string> own;
  /// Poses of the shown bodies, world frame. The order of the bodies is that of the argument `order` of
  /// take(). If there are n shown bodies, the list has 4 n entries: first x of all bodies, then y of all
  /// bodies, then all headings, then z of all bodies.
  ///
  /// The unit of x, y and z is worldio::k_replay_step_m (1 mm); they are clamped to +-1000 km. A heading is a
  /// whole number from 0 to worldio::k_replay_turn - 1, counter-clockwise from the x axis;
  /// worldio::k_replay_turn units are a full turn. If a body is not in the world, its heading is k_gone, and
  /// its x, y and z are 0.
  std::vector<std::int32_t> poses;
  /// Colours: three bytes for each entry, red, green and blue. The first entries are the colours of the shown
  /// bodies. The next entries are the colours of parts (pieces of bodies) that have a colour of their own,
  /// such as LEDs. They follow the argument `parts` of take(): each element of `parts` stands for one part of
  /// all bodies of one type, and has one entry per body of this type.
  ///
  /// Empty if the argument `has_colors` of take() was false.
  std::vector<std::uint8_t> colors;
  /// A viewer can colour the bodies by a value of the state, such as their speed. For each client that
  /// requested this: one byte per shown body, computed by take_shades() (live/watched.hpp). 1 is the lowest
  /// value, 255 the highest; 0: the body has no value. The keys of the map are numbers of clients.
  std::map<std::uint64_t, std::vector<std::uint8_t>> shades;
};
/// The heading, in Picture::poses, of a body that is not in the world.
inline constexpr std::int32_t k_gone = -1;

/// Sets Picture::poses and Picture::colors to the present state of the world. The other members of `picture`
/// do not change.
///
/// order: ids of the shown bodies (worldio::LivePage::order)
/// has_colors: true if a device, such as an LED, can change the colour of a shown body or of one of its
///     parts; must be true if `parts` is not empty
/// parts: the parts with a colour of their own (worldio::LivePage::shown_parts)
void take(const engine::World& world, std::span<const std::uint32_t> order, bool has_colors,
          std::span<const worldio::ShownPart> parts, Picture& picture);

/// The values that were last sent to one client. encode() compares a picture with them. The lists are as in
/// Picture (`shades`: the list of this client); they are empty before the first picture is sent.
struct SentPicture {
  std::uint64_t number = 0;  ///< Picture::number; 0 if no picture was sent
  std::vector<std::int32_t> poses;
  std::vector<std::uint8_t> colors;
  std::vector<std::uint8_t> shades;
};

/// Encodes a picture for one client, as the content of a binary WebSocket message (docs/live-protocol.md).
/// The message has the number of the picture, and the poses, colours and shades that differ from `sent`, the
/// values that were last sent to this client. The function then sets `sent` to the values of the picture.
///
/// If the picture has no shades for this client, the message contains no shades, and `sent.shades` does not
/// change.
///
/// robots: number of shown bodies
/// client: number of the client, the key of its shades in Picture::shades
std::string encode(const Picture& picture, std::size_t robots, std::uint64_t client, SentPicture& sent);

}  // namespace troupe::live
