#include "engine/spec/watch_spec.hpp"

namespace troupe::engine {

const FieldTable& watch_fields() { return described<WatchSpec>(); }

Record watch_record(const WatchSpec& watch) { return to_record(watch); }

WatchSpec watch_spec(const Record& record) { return from_record<WatchSpec>(record); }

}  // namespace troupe::engine
