#pragma once

#include <string_view>

namespace troupe::live {

/// The HTML page of `troupe view`: the content of apps/replay_page/live.html, which scripts/replay-page
/// builds.
extern const std::string_view k_view_page;

}  // namespace troupe::live
