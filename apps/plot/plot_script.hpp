#pragma once

#include <string_view>

namespace troupe::apps {

/// The text of the script python/troupe/plot.py, which is embedded in this program.
extern const std::string_view k_plot_script;

}  // namespace troupe::apps
