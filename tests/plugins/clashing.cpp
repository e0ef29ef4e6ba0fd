// Plug-ins with names that cannot be: built as clash.so, two controllers of one name; as expand.so, a name
// that Troupe's own controller has; as twice.so and ranger.so, the same of sensors; as unprepared.so, a
// sensor whose kind lacks what it needs; as misnamed.so, a sensor and a controller with parameters that are
// called like keys of JSON worlds; as command.so, a controller that is called like a component of the state.
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
