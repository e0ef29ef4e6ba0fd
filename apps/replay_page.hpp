#pragma once

#include <string_view>

namespace troupe::apps {

/// The HTML page into which `troupe replay` inserts a recording: the content of apps/replay_page/replay.html,
/// which scripts/replay-page builds.
extern const std::string_view k_replay_page;

}  // namespace troupe::apps
