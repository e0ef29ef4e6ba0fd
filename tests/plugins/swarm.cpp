// One of the two files of a plug-in with several controllers; the other is swarm_main.cpp.
#include <troupe/plugin.hpp>

namespace {

struct Leader {
  void operator()(const troupe::Percept& percept, troupe::Random&, troupe::Actions& actions) const {
    actions.command = {0.1, 0, percept.body % 2 == 0 ? 0.1 : -0.1};
  }
};
struct Follower {
  void operator()(const troupe::DecideBatch& batch) const {
    for (std::size_t i = 0; i < batch.size(); ++i) batch.command(i).x = 0.2;
  }
};

}  // namespace

TROUPE_CONTROLLER("leader", Leader)
TROUPE_CONTROLLER("follower", Follower)
