#pragma once

#include "apps/command_table.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// The manual page troupe(1) in the man macros of roff: every command with its options, made from what
/// --help prints. `version` stands at the foot of each page.
std::string manual_page(const std::vector<Command>& commands, std::string_view version);

}  // namespace troupe::apps
