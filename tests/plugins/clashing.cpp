// Built as clash.so: two controllers of one name; built as expand.so: a name that Troupe's own controller
// has.
#include <troupe/plugin.hpp>

namespace {

struct Idle {
  void operator()(const troupe::Percept&, troupe::Random&, troupe::Actions&) const {}
};

}  // namespace

#ifdef TWICE
TROUPE_CONTROLLER("idle", Idle)
TROUPE_CONTROLLER("idle", Idle)
#else
TROUPE_CONTROLLER("expand", Idle)
#endif
