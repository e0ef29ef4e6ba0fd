#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"
#include "engine/kinds/registry.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// Options of `troupe describe`. A kind is an implementation of a sensor, a drive, a controller and so on,
/// which world files select by its name.
struct DescribeOptions {
  std::string name;     ///< kind or key of JSON worlds to describe, such as "ranger"; empty: list all kinds
  bool schema = false;  ///< print the JSON Schema of worlds instead
  bool stage = false;   ///< also list the properties of a sensor or device in Stage's world files
  KindSources sources;  ///< plug-ins and scripts whose kinds can be described
};
/// Adds the options of `describe`; parsing fills `options`, which must outlive `command`.
void add_describe_options(CLI::App& command, DescribeOptions& options);
/// `troupe describe`: prints the list of all kinds, the description of one kind or key, or the JSON Schema of
/// worlds. Throws InputError for an unknown name.
ExitCode describe(const DescribeOptions& options);

/// Returns the names of all kinds of models, devices, drives, controllers, measures and faults, and of the
/// presets of controllers. The names are sorted, without duplicates.
std::vector<std::string_view> kind_names(const engine::Registry& registry);

}  // namespace troupe::apps
