#pragma once

// The reasons why a library cannot be used, for the macro FAULT of unusable.cpp.
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

namespace troupe::plugin {

struct Library;

/// Returns the interface of a plug-in that cannot be used for the reason `fault`. It has no fault if the
/// reason is one that unusable.cpp implements.
const Library* unusable_library(int fault);

}  // namespace troupe::plugin
