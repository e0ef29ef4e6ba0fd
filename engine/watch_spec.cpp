#include "engine/watch_spec.hpp"

namespace troupe::engine {
const FieldTable& watch_fields() {
  static const FieldTable table{{
      {.name = "clock", .type = FieldType::boolean, .fallback = false, .text = "tell the time on the way"},
      {.name = "clock_ticks",
       .type = FieldType::integer,
       .fallback = 100,
       .min = 1,
       .max = static_cast<double>(k_most_clock_ticks),
       .text = "how often"},
      {.name = "rate",
       .fallback = 1.0,
       .min = 0,
       .max = k_most_rate,
       .text = "the world's own pace, times real time, for `--rate world`; 0: as fast as possible"},
      {.name = "paused",
       .type = FieldType::boolean,
       .fallback = false,
       .text = "a window would begin at rest"},
  }};
  return table;
}

Record watch_record(const WatchSpec& watch) {
  const auto& [clock, clock_ticks, rate, paused] = watch;
  return {clock, static_cast<std::int64_t>(clock_ticks), rate, paused};
}

WatchSpec watch_spec(const Record& record) {
  return {record[0].boolean(), static_cast<std::uint64_t>(record[1].integer()), record[2].number(),
          record[3].boolean()};
}

}  // namespace troupe::engine
