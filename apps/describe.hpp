#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"
#include "engine/kinds/kinds.hpp"
#include "troupe/plugins.hpp"
#include "troupe/script.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// Options of `troupe describe`. A kind is an implementation of a sensor, a drive, a controller and so on,
/// which world files select by its name.
struct DescribeOptions {
  std::string name;     ///< kind or key of JSON worlds to describe, such as "ranger"; empty: list all kinds
  bool schema = false;  ///< print the JSON Schema of worlds instead
  KindSources sources;  ///< plug-ins and scripts whose kinds can be described
};
/// Adds the options of `describe`; parsing fills `options`, which must outlive `command`.
void add_describe_options(CLI::App& command, DescribeOptions& options);
/// `troupe describe`: prints the list of all kinds, the description of one kind or key, or the JSON Schema of
/// worlds. Throws InputError for an unknown name.
ExitCode describe(const DescribeOptions& options);

/// Returns a list of all kinds (implementations of sensors, drives, controllers and so on) as text: one line
/// with name and description per kind, under a heading per group. The groups are models, sensors, devices,
/// drives, controllers, presets (named controllers with default parameters of their own), measures, faults
/// and events.
std::string list_kinds(const engine::Registry& registry);
/// Returns a list of the controllers and measures of a script as text, in the same form.
std::string list_script(const Script& script);

/// Returns the names of all kinds that list_kinds() lists. Events are not included. The names are sorted,
/// without duplicates.
std::vector<std::string_view> kind_names(const engine::Registry& registry);

/// Returns a text that describes the kind or the key of JSON worlds to which `name` refers. If several kinds
/// or keys have this name, such as a model and a sensor, the text describes all of them.
///
/// For a kind, the text lists the parameters, each with JSON key, units, default, range and meaning. For a
/// device, it also lists the fields of the readings and of the command; for a controller, what it needs of a
/// robot. For a measure, it contains the definition. worldio::find_keys() finds the keys. A name such as
/// "sensors.ranger" also refers to a kind.
///
/// plugins: the plug-ins (shared libraries with further kinds) of the registry, as add_plugins() returns
/// them; they are searched too. Throws InputError if there is no such kind or key; the error suggests similar
/// names.
std::string describe_name(const engine::Registry& registry, Plugins& plugins, std::string_view name);

}  // namespace troupe::apps
