// The other file of the plug-in of swarm.cpp.
#include <troupe/plugin.hpp>

namespace {

struct Straight {
  static constexpr std::array<std::string_view, 2> k_uses{"ranger", "ranger"};
  void operator()(const troupe::Percept&, troupe::Random&, troupe::Actions& actions) const {
    actions.command.x = 0.3;
  }
};

}  // namespace

TROUPE_CONTROLLER("needy", Straight)
