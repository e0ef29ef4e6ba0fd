// Libraries that cannot be used; FAULT selects the reason. Each is compiled from this source and linked with
// unusable_library.cpp, which is compiled only once because it includes the headers of plug-ins.
#include "tests/plugins/unusable.hpp"

#if FAULT == FAULT_of_stage
extern "C" __attribute__((visibility("default"))) int Init(void*, void*) { return 0; }
#elif FAULT == FAULT_nothing
extern "C" __attribute__((visibility("default"))) int troupe_nothing() { return 0; }
#else

namespace troupe {
double no_such_function(double x);
}

extern "C" __attribute__((visibility("default"))) const troupe::plugin::Library* troupe_plugin() {
#if FAULT == FAULT_undefined_symbol
  troupe::no_such_function(1);
#endif
  if (FAULT == FAULT_throwing_at_once) throw 42;
  return FAULT == FAULT_null ? nullptr : troupe::plugin::unusable_library(FAULT);
}
#endif
