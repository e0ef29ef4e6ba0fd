#pragma once

#include <cstdint>
#include <vector>

namespace troupe::engine {

class World;

/// How the ranks (threads or processes) that compute one world share the rows of a state table. A row is the
/// data of one body in the table. Each row has an *owner*: the rank that runs the sensors, devices, drive and
/// controllers of the row's body. The phases of a tick (time step) are listed in engine/world/phase.hpp.
enum class Sharing : std::uint8_t {
  alike,  ///< every rank computes all rows that it has, in the phases intervene and move; nothing is sent
  sent,   ///< the owner computes a row and sends it to ranks that have it, in each tick before the phase move
  kept,   ///< the owner computes a row; other ranks have old values, but World::gather() updates rank 0
};
/// Returns how each state table of a world is shared, in the order of World::tables(). The result follows
/// from the tables and from what the kinds of devices (tables of functions that implement devices) declare.
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
