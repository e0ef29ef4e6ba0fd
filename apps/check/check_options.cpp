#include "apps/check/check_options.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <string>
#include <string_view>

namespace troupe::apps {
namespace {

constexpr const char* k_check_footer = R"(
Loads a variant of the world for each number of threads with each tile size, steps them side by side, and compares
every component of the state after each tick. Stops at the first tick that differs and names component, robot and
field, with both values.

--amnesia adds two variants to those. In one, whatever is not state is overwritten with junk after each tick and
derived again; the other is discarded after each tick, and goes on as a new world made from the world's description
and its state, as a resumed run does. They find what influences a later tick and is not part of the state.

--controllers has every decision of the first variant taken twice more, from the same readings and memory: in another
order, on another thread, from storage filled with junk; and by a controller made afresh. A controller that calls
rand(), keeps a static, reads the clock or leaves a member unset is named, with the field. Takes a second more at the
first decision, for clocks that count seconds. docs/determinism.md tells what it cannot see.

The end is that of troupe run: --for S, else the world's quit_time.

Exit codes: 0 same bits; 1 they differ; 2 bad input or usage.

Examples:
  troupe check worlds/crowd.json --for 5
  troupe check worlds/hospital.json --for 5 --threads 1,2,3,4,8 --tile-size auto,1.7,45.1
  troupe check worlds/failures.json --for 20 --threads 1 --tile-size auto --amnesia
  troupe check worlds/cave-simple.json --for 5 --threads 2 --tile-size auto --controllers)";

/// Calls each with every item of a list like 1,2,8.
template <class Each>
void split(const std::string& text, Each&& each) {
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    each(std::string_view(text).substr(start, end - start));
    start = end + 1;
  }
}

}  // namespace

void add_check_options(CLI::App& check, CheckOptions& options) {
  check.footer(k_check_footer);
  add_world_options(check, options);
  add_value(check, "--threads", "N,...", "Numbers of worker threads (default: 1,2,8)",
            [&options](const std::string& text) {
              options.threads.clear();
              split(text, [&](std::string_view item) { options.threads.push_back(thread_count(item)); });
            });
  add_value(check, "--tile-size", "M,...",
            "Edges of tiles, m; auto: as the world chooses (default: auto,1.7)",
            [&options](const std::string& text) {
              options.tile_sizes_m.clear();
              split(text, [&](std::string_view item) {
                options.tile_sizes_m.push_back(item == "auto" ? 0 : tile_size_m(item));
              });
            });
  check
      .add_flag("--amnesia", options.amnesia,
                "Also compare runs that keep nothing but their state after a tick")
      ->disable_flag_override();
  check.add_flag("--controllers", options.controllers, "Have each decision taken again, and compare")
      ->disable_flag_override();
}

}  // namespace troupe::apps
