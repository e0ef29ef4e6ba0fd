#pragma once

#include <string_view>

namespace troupe::apps {

/// The page that `troupe replay` fills in: apps/replay_page/replay.html, which scripts/replay-page makes.
extern const std::string_view k_replay_page;

}  // namespace troupe::apps
