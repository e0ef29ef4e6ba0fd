#pragma once

#include <string_view>

namespace troupe::live {

/// The HTML page of the live view, which shows a running world in a browser (command `troupe view`, class
/// View). The build copies it from the file apps/replay_page/live.html, which scripts/replay-page generates.
extern const std::string_view k_view_page;

}  // namespace troupe::live
