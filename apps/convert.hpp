#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {

/// Options of `troupe convert`. Both files may be in Stage's format (.world) or in JSON (.json).
struct ConvertOptions {
  std::filesystem::path in;   ///< world file to read
  std::filesystem::path out;  ///< world file to write; its ending, .world or .json, selects the format
  bool force = false;         ///< replace an existing output file
  /// Values of the world to replace: pairs of a JSON pointer and a JSON value, as in SimulationOptions::set.
  std::vector<std::pair<std::string, std::string>> set;
  KindSources sources;  ///< plug-ins and scripts with kinds that the world names
};

/// Adds the options of `convert`; parsing fills `options`, which must outlive `command`.
void add_convert_options(CLI::App& command, ConvertOptions& options);

/// `troupe convert`: reads a world file, writes the world to another file, and prints the numbers of models
/// (bodies) and of their types. In a JSON world, a single entry (a population) may create many bodies. The
/// output has a separate entry for each of these bodies.
///
/// Returns k_finished. Throws OutputError if the output cannot be written, or if it exists and `force` is
/// false. Throws InputError if the world cannot be loaded, or cannot be expressed in the format of the
/// output.
ExitCode convert(const ConvertOptions& options);

}  // namespace troupe::apps
