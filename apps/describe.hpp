#pragma once

#include "apps/exit_code.hpp"
#include "engine/kinds.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// What the command line of `troupe describe` asks for.
struct DescribeOptions {
  std::string kind;  ///< empty: all
  bool schema = false;
  std::vector<std::filesystem::path> plugin_path;
};
/// Adds the options of `describe`; parsing fills `options`, which must outlive `command`.
void add_describe_options(CLI::App& command, DescribeOptions& options);
/// `troupe describe`: prints a list, a kind or the schema. Throws InputError for a kind that is not known.
ExitCode describe(const DescribeOptions& options);

/// Every model, sensor, drive, controller, preset, measure and event, a line each.
std::string list_kinds(const engine::Registry& registry);

/// The names of all kinds, sorted, each once.
std::vector<std::string_view> kind_names(const engine::Registry& registry);

/// The fields of every kind of this name (a model and a sensor may share one): JSON key with its units,
/// default, range and meaning; also of a controller of a plug-in that the registry finds. Throws InputError
/// with near names when there is none.
std::string describe_kind(const engine::Registry& registry, std::string_view name);

}  // namespace troupe::apps
