#pragma once

#include <cstdint>
#include <vector>

namespace troupe::engine {

class World;

/// How the ranks that compute one world share the rows of a state table. Each row has an *owner*: the rank
/// that senses, actuates and decides for the row's body.
enum class Sharing : std::uint8_t {
  alike,  ///< every rank computes all rows that it has, in the phases intervene and move; nothing is sent
  sent,   ///< the owner computes a row and sends it to ranks that have it, in each tick before the phase move
  kept,   ///< the owner computes a row; other ranks have old values, except rank 0 after gather()
};
/// Returns how each state table of a world is shared, in the order of World::tables(). This follows from the
/// tables and from what the kinds of devices declare.
///
/// kept    Most readings of sensors, because only the controllers of the sensor's own body read them. Also
///         the memories of controllers, and most commands.
/// sent    The velocities of drives, from which every rank computes the motions. The states of devices that
///         act or set a colour, because other bodies may read them. Also the readings and commands that a
///         kind of device in the world declares that it reads (DeviceKind::reads), and the commands to
///         devices with hooks in the phase move.
/// alike   All other tables.
std::vector<Sharing> sharing_of(const World& world);

}  // namespace troupe::engine
