#pragma once

#include <string_view>

namespace troupe::apps {

/// The page of `troupe view`: apps/replay_page/live.html, which scripts/replay-page makes.
extern const std::string_view k_view_page;

}  // namespace troupe::apps
