#pragma once

#include <cstdint>
#include <vector>

namespace troupe::engine {

class World;

/// How the ranks (threads or processes) that compute one world share the rows of a state table. A row is the
/// data of one body in the table. Each row has an *owner*: the rank that runs the sensors, devices, drive and
/// controllers of the row's body. Other ranks may have copies of the row. A tick (time step) consists of
/// phases. In the phase `intervene`, changes that the world file lists are made. In the phase `move`, bodies
/// move (engine/state/phase.hpp).
enum class Sharing : std::uint8_t {
  alike,  ///< every rank computes all rows that it has, in the phases intervene and move; nothing is sent
  sent,   ///< the owner computes a row and sends it to ranks that have it, in each tick before the phase move
  kept,   ///< the owner computes a row; other ranks have old values, but World::gather() updates rank 0
};
/// Returns how the ranks share each state table of a world, in the order of World::tables(). A *kind* is the
/// table of functions that implements devices. It declares which data of other bodies its devices read
/// (DeviceKind::reads).
///
/// sent:
/// - the velocities of drives, because every rank computes motions from them
/// - the states of devices that other bodies may read: of devices that act (DeviceKind::is_sensor() is
///   false), supply power or set a colour
/// - the states of and the commands to devices whose kind has a function that the phase move calls
///   (DeviceKind::joints_moved, apply or born)
/// - all other states and commands that a kind in the world declares in DeviceKind::reads
///
/// kept: all other states of devices (these are the readings of most sensors), all other commands, what
/// blocked bodies, and the memories of controllers. Only the devices and controllers of the row's own body
/// read them.
///
/// alike: all other tables.
std::vector<Sharing> sharing_of(const World& world);

}  // namespace troupe::engine
