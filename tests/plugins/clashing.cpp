// Plug-ins with names that are not allowed. clash.so: two controllers of one name; expand.so: the name of a
// built-in controller; twice.so and ranger.so: the same for sensors; unprepared.so: a sensor whose kind lacks
// a required function; misnamed.so: a device with a parameter named like a key of JSON worlds; command.so: a
// controller named like a component of the state.
#include <troupe/plugin.hpp>

namespace {

struct Idle {
  void operator()(const troupe::Percept&, troupe::Random&, troupe::Actions&) const {}
};

struct Misnamed {
  struct Params {
    double active = 0;

    static constexpr void describe(troupe::Description<Params>& d) {
      d.member<&Params::active>("active", "");
    }
  };
  Params params;
};

[[maybe_unused]] troupe::DeviceKind misnamed() { return troupe::make_device_kind<Misnamed>("misnamed", ""); }

[[maybe_unused]] troupe::DeviceKind unprepared() { return {.name = "unprepared"}; }

}  // namespace

#if defined(CLASH)
TROUPE_CONTROLLER("idle", Idle)
TROUPE_CONTROLLER("idle", Idle)
#elif defined(EXPAND)
TROUPE_CONTROLLER("expand", Idle)
#elif defined(COMMAND)
TROUPE_CONTROLLER("command", Idle)
#elif defined(TWICE)
TROUPE_DEVICE("twice", troupe::ranger_kind)
TROUPE_DEVICE("twice", troupe::ranger_kind)
#elif defined(RANGER)
TROUPE_DEVICE("ranger", troupe::ranger_kind)
#elif defined(MISNAMED)
TROUPE_DEVICE("misnamed", misnamed)
#else
TROUPE_DEVICE("unprepared", unprepared)
#endif
