#include "apps/sweep/identity.hpp"

#include "apps/messages.hpp"
#include "apps/options.hpp"
#include "apps/sweep/one_run.hpp"
#include "base/hash.hpp"
#include "engine/world/world.hpp"
#include "troupe/input_files.hpp"
#include "troupe/measures.hpp"
#include "troupe/simulation.hpp"
#include "worldio/files.hpp"
#include "worldio/json/spec_json.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>

namespace troupe::apps {
namespace {

namespace fs = std::filesystem;
using worldio::Study;

/// Returns the world of the first run whose world can be loaded. Of a large study, it tries only some runs,
/// less and less densely, because loading all worlds can take hours. Throws the InputError of run 0 if it
/// finds no such run.
Simulation first_world(const Study& study, const SweepOptions& options) {
  std::exception_ptr first;
  for (std::size_t run = 0; run < study.run_count(); run += 1 + run / 4) try {
      return Simulation(study.world, simulation_options(study, study.run(run), options));
    } catch (const InputError&) {
      if (!first) first = std::current_exception();
    }
  std::rethrow_exception(first);
}

/// The contents of a loaded world, with its images, as text. It does not depend on the folders of the files.
std::string world_of(const Simulation& simulation) {
  auto spec = nlohmann::json::parse(worldio::spec_to_json(simulation.world().spec(), simulation.registry()));
  spec.erase("files");
  return fmt::format("{}\n{:016x}\n", spec.dump(), simulation.state_hash());
}

/// The plug-ins and scripts of a loaded world, each with a hash of its file.
StudyFacts plugins_of(const Simulation& simulation) {
  StudyFacts plugins;
  for (const auto& [option, value] : simulation.effective_options())
    if (option.starts_with("plugin ")) plugins.emplace_back(option, value);
  return plugins;
}

/// The contents of the files of a loaded world, with its included files and images, but without scripts. The
/// loaded world itself would not do: it also depends on its plug-ins.
std::string files_of(const Simulation& simulation, const SweepOptions& options) {
  std::string text;
  for (const fs::path& file : input_files(simulation.world().spec())) {
    const bool is_script = std::ranges::any_of(
        options.sources.scripts, [&](const auto& script) { return same_file(script->file, file); });
    if (!is_script) text += worldio::read_file(file).value_or("") + '\n';
  }
  return text;
}

std::string contents_of(const Simulation& simulation) {
  std::string text = world_of(simulation);
  for (const auto& [plugin, hash] : plugins_of(simulation)) text += fmt::format("{} {}\n", plugin, hash);
  return text;
}

/// Whether a JSON value is or contains the path of a file, relative to the folder of the world, or the name
/// of a kind of a plug-in in one of these folders: "walker" and "walker:fast" are kinds of walker.so.
bool names_file(const nlohmann::json& value, const fs::path& world, const std::vector<fs::path>& plugins) {
  if (value.is_string()) {
    const auto text = value.get<std::string>();
    const std::string library = text.substr(0, text.find(':')) + ".so";
    std::error_code ignored;
    return fs::is_regular_file(world.parent_path() / text, ignored) ||
           std::ranges::any_of(plugins, [&](const fs::path& folder) {
             return fs::is_regular_file(folder / library, ignored);
           });
  }
  return std::ranges::any_of(value, [&](const auto& element) {
    return value.is_structured() && names_file(element, world, plugins);
  });
}

/// What is known of the worlds with each listed value of a parameter that names a file, such as the image of
/// a floor plan or a plug-in: the file is not part of the study, and run 0 may not read it.
struct Choices {
  std::string hashes = {};  ///< of contents_of()
  std::string files = {};   ///< files_of()
  StudyFacts plugins = {};  ///< plugins_of()
};

Choices choices_of(const Study& study, const SweepOptions& options) {
  const std::vector<fs::path> plugins = plugin_path(options.sources.plugin_path);
  Choices choices;
  for (std::size_t p = 0; p < study.choices.size(); ++p)
    for (std::size_t i = 0; i < study.choices[p].values.size(); ++i) {
      const std::string& value = study.choices[p].values[i];
      if (!names_file(nlohmann::json::parse(value), study.world, plugins)) continue;
      Study::Run run = study.run(0);
      for (std::size_t q = 0; q < study.choices.size(); ++q)  // those that vary together
        if (study.leader_of(q) == study.leader_of(p)) run.values[q] = study.choices[q].value(i);
      try {
        const Simulation simulation(study.world, simulation_options(study, run, options));
        choices.hashes += hex(hash_text(contents_of(simulation)));
        choices.files += files_of(simulation, options);
        for (auto& plugin : plugins_of(simulation)) choices.plugins.push_back(std::move(plugin));
      } catch (const InputError&) {
        choices.hashes += value;  // only other runs, or none, can have this value
      }
    }
  return choices;
}

SweepIdentity unchecked_identity(const Study& study, const SweepOptions& options, bool shows_warnings) {
  Simulation simulation = first_world(study, options);
  const Measures measures(simulation, study.measures);
  end_time_s(study, simulation);
  if (shows_warnings) print_lines(simulation.warnings());
  const std::string study_text = worldio::read_file(options.study).value_or("");
  const Choices choices = choices_of(study, options);
  const std::string text =
      fmt::format("{}\n{}{}{}", study_text, contents_of(simulation), choices.hashes, version_line());
  StudyFacts facts{{"version", version_line()},
                   {"study_file", hex(hash_text(study_text))},
                   {"world", hex(hash_text(files_of(simulation, options) + choices.files))}};
  StudyFacts plugins = plugins_of(simulation);
  plugins.insert(plugins.end(), choices.plugins.begin(), choices.plugins.end());
  for (auto& plugin : plugins)
    if (std::ranges::find(facts, plugin.first, &StudyFacts::value_type::first) == facts.end())
      facts.push_back(std::move(plugin));
  return {hex(hash_text(text)),
          std::move(facts),
          {measures.columns().begin(), measures.columns().end()},
          simulation.world().spec().seed};
}

/// Returns the errors of a run, one per line, with positions in the study. A run sets each parameter of the
/// study as `--set POINTER` does, and computes its measures as `--measure NAME` does: in errors that name
/// such an option, the position of the parameter or of the measure in the study file replaces the option.
std::string at_study(const Study& study, const std::string& errors, const Diagnostics& diagnostics) {
  std::string text;
  std::istringstream lines(errors);
  for (std::string line; std::getline(lines, line);) {
    const auto place = [&](const std::string& source, const Where& where, const std::string& pointer) {
      const std::string mark = source + ": error: ";
      if (line.starts_with(mark))
        line = diagnostics.text(
            {Severity::error, where, fmt::format("{}: {}", pointer, line.substr(mark.size()))});
    };
    for (std::size_t p = 0; p < study.parameters.size(); ++p)
      place("--set " + study.parameters[p].pointer, study.parameters[p].where,
            fmt::format("/parameters/{}", p));
    for (std::size_t m = 0; m < study.measures.size(); ++m)
      place("measure " + study.measures[m], study.where_measures[m], fmt::format("/measures/{}", m));
    text += (text.empty() ? "" : "\n") + line;
  }
  return text;
}

}  // namespace

SweepIdentity identify(const worldio::Study& study, const SweepOptions& options, bool shows_warnings,
                       Diagnostics& diagnostics) {
  if (const Result<> readable = worldio::check_readable(study.world); !readable)
    diagnostics.error(study.where_world,
                      fmt::format("/world: {}: {}", study.world.string(), readable.error().text));
  diagnostics.throw_if_errors();
  SweepIdentity identity;
  try {
    identity = unchecked_identity(study, options, shows_warnings);
  } catch (const InputError& error) {
    throw InputError(at_study(study, error.what(), diagnostics));
  }
  worldio::check_columns(study, identity.measures, diagnostics);
  diagnostics.throw_if_errors();
  return identity;
}

}  // namespace troupe::apps
