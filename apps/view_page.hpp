#pragma once

#include <string_view>

namespace troupe::apps {

/// The page of `troupe view`: apps/replay_page/live.html, built by scripts/replay-page.
extern const std::string_view k_view_page;

}  // namespace troupe::apps
