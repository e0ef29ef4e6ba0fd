#include "tests/plugins/unusable.hpp"

#include "troupe/plugin_library.hpp"

#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace troupe::plugin {
namespace {

bool contracts_not() { return false; }
bool contracts_always() { return true; }

void list_nothing(std::vector<engine::ControllerKind>&, std::vector<engine::DeviceKind>&,
                  std::vector<engine::MeasureKind>&) {}
void throw_error(std::vector<engine::ControllerKind>&, std::vector<engine::DeviceKind>&,
                 std::vector<engine::MeasureKind>&) {
  throw std::runtime_error("a table is missing");
}
void throw_number(std::vector<engine::ControllerKind>&, std::vector<engine::DeviceKind>&,
                  std::vector<engine::MeasureKind>&) {
  throw 42;
}

std::atomic<std::uint64_t> contents_of_unusable = 0;

}  // namespace

const Library* unusable_library(int fault) {
  static const Library library{fault == FAULT_old_interface ? 3 : k_interface,
                               fault == FAULT_another_version ? "99.1.0" : k_version,
                               fault == FAULT_another_build ? "libc++, vectorized Eigen" : k_build,
                               layout() + (fault == FAULT_other_headers ? 1 : 0),
                               fault == FAULT_contracting ? contracts_always : contracts_not,
                               fault == FAULT_throwing            ? throw_error
                               : fault == FAULT_throwing_a_number ? throw_number
                                                                  : list_nothing,
                               &contents_of_unusable};
  return &library;
}

}  // namespace troupe::plugin
