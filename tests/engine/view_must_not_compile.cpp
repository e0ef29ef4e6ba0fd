// A device that reads its own velocity in `act`, compiled with -DFAULT=NAME: NONE compiles, and each other
// fault must fail (tests/CMakeLists.txt has the errors).

#include "engine/kinds/make_device_kind.hpp"
#include "engine/sensing/sensing_view.hpp"

#define NONE 1
#define VELOCITY 2
#define VELOCITIES 3
#define COMMAND 4
#define STATE 5
#define WORLD 6

namespace troupe::engine {

struct Follower {
  struct State {
    double speed = 0;
    TROUPE_FIELDS(speed)
  };

  double speed(const DeviceBatch& batch, std::size_t i) const {
#if FAULT == VELOCITY
    const Row other((batch.rows[i].index() + 1) % batch.view.rows());
    return batch.view.velocity(other).x;
#elif FAULT == VELOCITIES
    return batch.view.velocities()[0].x;
#elif FAULT == COMMAND
    return batch.view.command(Row(0)).x;
#elif FAULT == STATE
    return batch.view.percepts(batch.view.type(Row(0)).devices[0]).as<State>(0).speed;
#elif FAULT == WORLD
    return batch.world.velocities()[0].x;
#else
    return batch.velocity(i).x;
#endif
  }

  void act(const DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i)
      batch.state.as<State>(batch.slot(i)).speed = speed(batch, i);
  }
  /// The last tick has committed the velocities of others.
  std::uint64_t sense(const SenseBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i)
      batch.state.as<State>(batch.slot(i)).speed = batch.committed.velocity(Row(0)).x;
    return 0;
  }
};

DeviceKind follower_kind() { return make_device_kind<Follower>("follower", "reads velocities"); }

}  // namespace troupe::engine
