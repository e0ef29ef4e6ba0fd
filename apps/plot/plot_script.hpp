#pragma once

#include <string_view>

namespace troupe::apps {

/// The text of python/troupe/plot.py.
extern const std::string_view k_plot_script;

}  // namespace troupe::apps
