#pragma once

#include <string_view>

namespace troupe::apps {

/// The page into which `troupe replay` inserts a recording: apps/replay_page/replay.html, built by
/// scripts/replay-page.
extern const std::string_view k_replay_page;

}  // namespace troupe::apps
