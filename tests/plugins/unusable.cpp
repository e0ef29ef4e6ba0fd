// Libraries that cannot be used; FAULT selects the reason.
#define FAULT_of_stage 1
#define FAULT_nothing 2
#define FAULT_undefined_symbol 3
#define FAULT_another_version 4
#define FAULT_another_build 5
#define FAULT_other_headers 6
#define FAULT_contracting 7
#define FAULT_empty 8
#define FAULT_throwing 9
#define FAULT_throwing_a_number 10
#define FAULT_throwing_at_once 11
#define FAULT_null 12
#define FAULT_old_interface 13

#if FAULT == FAULT_of_stage
extern "C" __attribute__((visibility("default"))) int Init(void*, void*) { return 0; }
#elif FAULT == FAULT_nothing
extern "C" __attribute__((visibility("default"))) int troupe_nothing() { return 0; }
#else

#include "troupe/plugin_library.hpp"

#include <stdexcept>

namespace troupe {
double no_such_function(double x);
}

namespace {

using namespace troupe;

bool contracts() { return FAULT == FAULT_contracting; }
void list(std::vector<engine::ControllerKind>&, std::vector<engine::DeviceKind>&,
          std::vector<engine::MeasureKind>&) {
  if (FAULT == FAULT_throwing) throw std::runtime_error("a table is missing");
  if (FAULT == FAULT_throwing_a_number) throw 42;
#if FAULT == FAULT_undefined_symbol
  no_such_function(1);
#endif
}
std::atomic<std::uint64_t> contents = 0;
const plugin::Library library{FAULT == FAULT_old_interface ? 3 : plugin::k_interface,
                              FAULT == FAULT_another_version ? "99.1.0" : k_version,
                              FAULT == FAULT_another_build ? "libc++, vectorized Eigen" : plugin::k_build,
                              plugin::layout() + (FAULT == FAULT_other_headers ? 1 : 0),
                              contracts,
                              list,
                              &contents};

}  // namespace

extern "C" __attribute__((visibility("default"))) const plugin::Library* troupe_plugin() {
  if (FAULT == FAULT_throwing_at_once) throw 42;
  return FAULT == FAULT_null ? nullptr : &library;
}
#endif
