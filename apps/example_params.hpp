#pragma once

#include "engine/kinds/device_kind.hpp"

#include <optional>

namespace troupe::apps {

/// Which parameters example_params() returns.
enum class Example {
  usual,  ///< the defaults, values for parameters that are required, and one object in each list of objects
  named,  ///< with a name in place of empty texts, too
  wide,   ///< at least 16 in each number of readings, and the largest field of view, so that most controllers
          ///< can use a device with these parameters
};

/// Returns parameters of a kind as a world could give them. Each parameter is valid, but a kind may reject
/// their combination.
engine::Record example_params(const engine::FieldTable& table, Example example);

/// Returns the readings and commands of a device with the parameters of example_params(), or nothing if the
/// kind rejects these parameters.
std::optional<engine::DeviceKind::Prepared> prepare_example(const engine::DeviceKind& kind, Example example);

}  // namespace troupe::apps
