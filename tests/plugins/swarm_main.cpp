// The other one.
#include <troupe/plugin.hpp>

namespace {

struct Straight {
  static constexpr std::size_t k_least_sensors = 2;
  void operator()(const troupe::Percept&, troupe::Random&, troupe::Actions& actions) const {
    actions.command.x = 0.3;
  }
};

}  // namespace

TROUPE_CONTROLLER("needy", Straight)
