#include "apps/observers/clock.hpp"

#include "apps/messages.hpp"
#include "apps/numbers.hpp"

#include <fmt/format.h>

namespace troupe::apps {

ClockLines::ClockLines(std::uint64_t every_ticks, const Simulation& simulation)
    : every_ticks_(every_ticks), first_s_(simulation.time_s()) {}

void ClockLines::observe(const Simulation& simulation) {
  if (simulation.tick() % every_ticks_ != 0) return;
  const double simulated_s = simulation.time_s() - first_s_;
  const double wall_s = std::chrono::duration<double>(WallClock::now() - start_).count();
  if (simulated_s > 0 && wall_s > 0)
    print_message(fmt::format("{}: {:.10g} s, {} x real time\n", printable_line(simulation.title()),
                              simulation.time_s(), four_digits(simulated_s / wall_s)));
  else
    print_message(fmt::format("{}: {:.10g} s\n", printable_line(simulation.title()), simulation.time_s()));
}

}  // namespace troupe::apps
