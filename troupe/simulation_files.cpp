#include "base/diagnostics.hpp"
#include "base/fp_environment.hpp"
#include "base/hash.hpp"
#include "engine/ranks/halo.hpp"
#include "partition/simd_target.hpp"
#include "troupe/build_info.hpp"
#include "troupe/effective_options.hpp"
#include "troupe/rank_processes.hpp"
#include "troupe/rank_team.hpp"
#include "troupe/registry.hpp"
#include "troupe/script.hpp"
#include "troupe/simulation_impl.hpp"
#include "troupe/world_builder.hpp"
#include "worldio/files.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/spec_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

// Simulations are made here, from files, specs and checkpoints, and saved in checkpoints.

namespace troupe {
namespace {

constexpr const char* k_spare = "spare";                // key in a header
constexpr std::string_view k_plugin = "plugin ";        // prefix of keys in a header: plugin NAME
constexpr const char* k_holds = "holds";                // key in the memories of a checkpoint
constexpr const char* k_stop_conditions = "stop_when";  // key in the memories of a checkpoint

/// Throws InputError for a checkpoint of another version unless `across_versions`. Returns a warning if
/// another version, or another build of this version, wrote the checkpoint.
std::optional<std::string> check_version(const worldio::Checkpoint& checkpoint, bool across_versions) {
  const std::string made_by = checkpoint.header("version");
  const std::string here = version_line();
  if (made_by == here) return {};
  const bool is_other = program_of(made_by) != program_of(here);
  if (is_other && !across_versions)
    throw InputError(
        fmt::format("{}: error: {} wrote this checkpoint, but this program is {}: results may differ; give "
                    "--across-versions (in C++ and Python: across_versions) to resume it anyway",
                    checkpoint.file().string(), program_of(made_by), program_of(here)));
  return fmt::format("{}: warning: the checkpoint was written by {}; this program is {}{}",
                     checkpoint.file().string(), made_by, here,
                     is_other ? ""
                              : ": the run continues with the same bits, because results do not depend on "
                                "compiler or processor (docs/determinism.md)");
}

/// Loads the plug-ins that a checkpoint was written with. Throws InputError if a plug-in is missing or is
/// another build. With `across_plugins` another build is accepted, and the result contains a warning for it.
std::vector<std::string> load_plugins(const worldio::Checkpoint& checkpoint, Plugins& plugins,
                                      bool across_plugins) {
  std::vector<std::string> warnings;
  for (const auto& [key, contents] : checkpoint.header()) {
    if (!key.starts_with(k_plugin)) continue;
    const std::string name = key.substr(k_plugin.size());
    const Result<const Plugins::Library*> loaded = plugins.load(name, true);
    if (!loaded)
      throw InputError(fmt::format("{}: error: the run needs plug-in \"{}\": {}", checkpoint.file().string(),
                                   name, loaded.error().text));
    const Plugins::Library* library = *loaded;
    if (hex(library->contents) == contents) continue;
    const std::string text =
        fmt::format("{} is another build of plug-in \"{}\" than the one that the checkpoint was written with",
                    library->file.string(), name);
    if (!across_plugins)
      throw InputError(
          fmt::format("{}: error: {} (its hash is {}, the checkpoint has {}): results may differ; "
                      "give --across-plugins (in C++ and Python: across_plugins) to resume it anyway",
                      checkpoint.file().string(), text, hex(library->contents), contents));
    warnings.push_back(fmt::format("{}: warning: {}", checkpoint.file().string(), text));
  }
  return warnings;
}

/// Adds a change by the option `set` to Simulation::Impl::changes. `when` follows the pointer in the key. All
/// keys differ, because recordings and hash logs store one value per key: a later value of a pointer replaces
/// an earlier one, except that each value for a pointer that appends to a list has its own number.
void add_setting(std::vector<std::pair<std::string, std::string>>& changes, const std::string& pointer,
                 const std::string& when, const std::string& value) {
  std::string key = "set " + pointer + when;
  if (pointer.ends_with("/-")) {
    const auto appends = std::ranges::count_if(changes, [&, numbered = key + " #"](const auto& change) {
      return change.first == key || change.first.starts_with(numbered);
    });
    if (appends > 0) key += fmt::format(" #{}", appends + 1);
  } else {
    std::erase_if(changes, [&key](const auto& change) { return change.first == key; });
  }
  changes.emplace_back(key, value);
}

/// Returns a word of a shell command, in quotes if it has other characters than letters, digits and a few
/// signs.
std::string shell_word(std::string_view word) {
  constexpr std::string_view k_plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=:,+-";
  if (!word.empty() && word.find_first_not_of(k_plain) == word.npos) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// Returns `command FILE` with the options that change which world is loaded, except the seed. `options` are
/// SimulationOptions or ResumeOptions.
template <class Options>
std::string command_of(std::string_view command, const std::filesystem::path& file, const Options& options) {
  std::string text = fmt::format("troupe {} {}", command, shell_word(file.string()));
  const auto add = [&text](std::string_view option, const std::string& value) {
    text += fmt::format(" {} {}", option, shell_word(value));
  };
  if constexpr (std::is_same_v<Options, SimulationOptions>) {
    for (const auto& [name, count] : options.robots)
      add("--robots", name.empty() ? std::to_string(count) : fmt::format("{}={}", name, count));
    if (options.ranging) add("--raytracer", std::string(engine::ranging_engine_name(*options.ranging)));
    if (options.spare > 0) add("--spare", std::to_string(options.spare));
  }
  for (const auto& [pointer, value] : options.set) add("--set", fmt::format("{}={}", pointer, value));
  for (const std::filesystem::path& folder : options.plugin_path) add("--plugin-path", folder.string());
  for (const auto& script : options.scripts) add("--controller", script->file.string());
  return text;
}

void append(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

}  // namespace

template <class Options>
void Simulation::Impl::make_world(engine::WorldSpec spec, const Options& options, Diagnostics& diagnostics) {
  RankOptions team{options.ranks, options.rank_seed, options.rank_clock, options.distribute};
  check_ranks(team);
  const engine::WorldOptions asked{threads_per_rank(options.threads, team.ranks), options.tile_size_m};
  engine::WorldOptions own = asked;
  if (options.processes && own.threads == 0) own.threads = options.processes->threads();
  world = std::make_unique<engine::World>(std::move(spec), *registry, own, diagnostics);
  if (team.distribute && (options.processes || team.ranks > 1)) {
    why_replicated = engine::why_replicated(*world);
    team.distribute = why_replicated.empty();
  }
  if (options.processes)
    ranks = options.processes->add(*world, *registry, *plugins, asked, options.rank_seed, team.distribute);
  else if (team.ranks > 1)
    ranks = std::make_unique<RankTeam>(*world, *registry, own, team);
}

void Simulation::Impl::watch_for_the_end(Diagnostics& diagnostics) {
  const std::vector<engine::StopSpec>& conditions = world->spec().experiment.stop_when;
  if (conditions.empty()) return;
  stop = std::make_unique<engine::StopConditions>(*world, *registry, conditions, diagnostics);
  diagnostics.throw_if_errors();
}

void Simulation::Impl::start(engine::WorldSpec spec, const SimulationOptions& options,
                             Diagnostics& diagnostics, std::span<const std::string> populations) {
  tile_size_m = options.tile_size_m;
  spec.mortal = spec.mortal || options.mortal;
  const auto records_contacts = [](const engine::RecordSpec& record) {
    return std::ranges::find(record.fields, "contact") != record.fields.end();
  };
  spec.contacts = spec.contacts || options.contacts || (spec.record && records_contacts(*spec.record));
  if (options.spare > SimulationOptions::k_most_spare)
    throw std::invalid_argument(fmt::format("SimulationOptions: spare is {}: give a number from 0 to {}",
                                            options.spare, SimulationOptions::k_most_spare));
  if (options.spare > 0) {
    engine::add_spare(spec, options.spare, populations);
    changes.emplace_back(k_spare, fmt::format("{}", options.spare));
  }
  spec.ranging = options.ranging.value_or(spec.ranging);
  make_world(std::move(spec), options, diagnostics);
  watch_for_the_end(diagnostics);
  warnings = diagnostics.warnings();
  append(warnings, plugins->warnings());
}

void Simulation::Impl::restore(const worldio::Checkpoint& checkpoint, Diagnostics& diagnostics) {
  checkpoint.restore(*world);
  resumed_at = checkpoint.tick();
  memories = checkpoint.memories();
  watch_for_the_end(diagnostics);
  if (stop) {
    const auto memory = memories.find(k_stop_conditions);
    for (const std::string& column :
         stop->remember(memory == memories.end() ? std::span<const std::byte>() : memory->second))
      if (world->tick() > 0)
        warnings.push_back(
            fmt::format("{}: warning: the checkpoint has no data of earlier ticks for the measure \"{}\" of "
                        "stop_when, which is new, or whose parameters or bounds were changed: the measure "
                        "begins at tick {}",
                        checkpoint.file().string(), column, world->tick()));
    if (world->tick() > 0) stop->ask();
  }
  if (const auto held = memories.find(k_holds);
      held != memories.end() && !holds.remember(held->second, world->spec().bodies.size()))
    throw InputError(fmt::format(
        "{}: error: the list of held robots (docs/live.md) in the checkpoint is invalid: the file is damaged",
        checkpoint.file().string()));
}

Simulation::Simulation(const std::filesystem::path& file, const SimulationOptions& options)
    : Simulation(file, options, make_registry()) {}

Simulation::Simulation(const std::filesystem::path& file, const SimulationOptions& options,
                       engine::Registry registry)
    : Simulation(load(file, options, std::move(registry), {},
                      [&](const engine::Registry& kinds, const worldio::LoadOptions& how,
                          Diagnostics& found) { return worldio::load_world(file, kinds, how, found); })) {}

Simulation Simulation::from_text(std::string text, const std::filesystem::path& name,
                                 const SimulationOptions& options) {
  return from_text(std::move(text), name, options, make_registry());
}

Simulation Simulation::from_text(std::string text, const std::filesystem::path& name,
                                 const SimulationOptions& options, engine::Registry registry) {
  return load(name, options, std::move(registry), {},
              [&](const engine::Registry& kinds, const worldio::LoadOptions& how, Diagnostics& found) {
                return worldio::load_world_text(name, std::move(text), kinds, how, found);
              });
}

Simulation::Simulation(const WorldBuilder& world, const SimulationOptions& options)
    : Simulation(world, options, make_registry()) {}

Simulation::Simulation(const WorldBuilder& world, const SimulationOptions& options, engine::Registry registry)
    : Simulation(
          load(world.name(), options, std::move(registry), {},
               [&](const engine::Registry& kinds, const worldio::LoadOptions& how, Diagnostics& found) {
                 return worldio::load_json_node(world.node(found.files()->add(world.name().string())),
                                                world.name(), kinds, how, found);
               })) {}

Simulation::Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name,
                       const SimulationOptions& options)
    : Simulation(world, name, options, make_registry()) {}

Simulation::Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name,
                       const SimulationOptions& options, engine::Registry registry)
    : Simulation(
          load(name, options, std::move(registry), world.files,
               [&](const engine::Registry& kinds, const worldio::LoadOptions& how, Diagnostics& found) {
                 return worldio::load_json_node(worldio::json_world_node(world, name, kinds, found), name,
                                                kinds, how, found);
               })) {}

namespace {

/// Adds an error after that of a setting whose last key is the name of a parameter of a script's controller.
/// Settings apply to the controllers that the world names, before those of scripts replace them.
void explain_settings(const SimulationOptions& options, Diagnostics& diagnostics) {
  if (!diagnostics.has_errors()) return;
  for (const auto& [pointer, value] : options.set) {
    const Where where{diagnostics.files()->add("--set " + pointer), 0};
    const std::string_view key = std::string_view(pointer).substr(pointer.rfind('/') + 1);
    const auto is_of_setting = [&](const Finding& finding) {
      return finding.severity == Severity::error && finding.where.file == where.file;
    };
    if (std::ranges::none_of(diagnostics.findings(), is_of_setting)) continue;
    for (const std::shared_ptr<const Script>& script : options.scripts)
      for (const Script::Controller& controller : script->controllers)
        if (std::ranges::any_of(controller.kind.params.fields,
                                [&](const auto& field) { return field.name == key; }))
          diagnostics.error(
              where, fmt::format("to set \"{}\" of the controller of {}, the world must name it: "
                                 "\"controller\": {{\"kind\": \"{}\"}}",
                                 key, script->file.string(), script->name_in_worlds(controller.kind.name)));
  }
}

/// Returns the kinds of the controllers of each type.
std::vector<std::vector<std::string>> controllers_of_types(const engine::WorldSpec& world) {
  std::vector<std::vector<std::string>> kinds(world.types.size());
  for (std::size_t t = 0; t < world.types.size(); ++t)
    for (const engine::ControllerSpec& controller : world.types[t].controllers)
      kinds[t].push_back(controller.kind);
  return kinds;
}

/// Reports an error for each setting of a controller that a controller of a script has replaced. In a study,
/// for example, all values of such a setting would give the same results. named: the controllers that the
/// world names, as controllers_of_types() returned them before the scripts' controllers were assigned.
void check_replaced_settings(const SimulationOptions& options, const engine::WorldSpec& world,
                             const std::vector<std::vector<std::string>>& named, Diagnostics& diagnostics) {
  const std::vector<std::vector<std::string>> assigned = controllers_of_types(world);
  for (const auto& [pointer, value] : options.set) {
    const auto tokens = worldio::pointer_tokens(pointer);
    if (!tokens || tokens->size() < 3 || (*tokens)[0] != "types") continue;
    if ((*tokens)[2] != "controller" && (*tokens)[2] != "controllers") continue;
    for (std::size_t t = 0; t < world.types.size(); ++t) {
      if (world.types[t].name != (*tokens)[1] || assigned[t].empty()) continue;
      const std::string& kind = assigned[t].front();  // a script gives a type one controller
      if (std::ranges::find(named[t], kind) != named[t].end()) continue;
      diagnostics.error(
          {diagnostics.files()->add("--set " + pointer), 0},
          fmt::format("has no effect, because the controller \"{0}\" of the script replaces the "
                      "controllers of type \"{1}\"; to set parameters of \"{0}\", the world must "
                      "name it: \"controller\": {{\"kind\": \"{0}\"}}",
                      kind, world.types[t].name));
    }
  }
}

/// Reports an error for each setting of a value that another option also gives. populations: the names of the
/// populations of the world.
void check_doubled_settings(const SimulationOptions& options, const std::vector<std::string>& populations,
                            Diagnostics& diagnostics) {
  std::vector<std::pair<std::string, std::string_view>> given;  // pointers and options
  if (options.seed) given.emplace_back("/seed", "--seed");
  if (options.ranging) given.emplace_back("/ranging", "--raytracer");
  for (const auto& [name, count] : options.robots)
    for (std::size_t p = 0; p < populations.size(); ++p)
      if (name.empty() || name == populations[p])
        given.emplace_back(fmt::format("/populations/{}/count", p), "--robots");
  for (const auto& [pointer, value] : options.set)
    for (const auto& [same, option] : given)
      if (pointer == same)
        diagnostics.error(
            {diagnostics.files()->add("--set " + pointer), 0},
            fmt::format("has no effect, because {} gives this value: omit one of them", option));
}

}  // namespace

/// Loads a world with `read`, which parses it. file: the name of the world. files: the source files that a
/// document states, for the file names in errors; null if the world is not loaded from a document.
Simulation Simulation::load(const std::filesystem::path& file, const SimulationOptions& options,
                            engine::Registry registry, std::shared_ptr<SourceFiles> files,
                            const ReadWorld& read) {
  restore_fp_environment();  // before anything is computed from the file
  auto impl = std::make_unique<Impl>();
  for (const auto& [pointer, value] : options.set) add_setting(impl->changes, pointer, "", value);
  impl->file = file;
  impl->registry = std::make_shared<engine::Registry>(std::move(registry));
  impl->plugins = add_plugins(*impl->registry, options.plugin_path, options.scripts);
  Diagnostics diagnostics(std::move(files));
  worldio::LoadOptions how{options.seed, options.robots, options.set, options.search_path, options.threads};
  how.place_again = &impl->place_again;
  std::vector<std::string> populations;
  how.populations = &populations;
  engine::WorldSpec spec = read(*impl->registry, how, diagnostics);
  explain_settings(options, diagnostics);
  check_doubled_settings(options, populations, diagnostics);
  diagnostics.throw_if_errors();
  const std::vector<std::vector<std::string>> named = controllers_of_types(spec);
  assign_controllers(options.scripts, spec, diagnostics);
  check_replaced_settings(options, spec, named, diagnostics);
  diagnostics.throw_if_errors();
  impl->start(std::move(spec), options, diagnostics, populations);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored) || !options.search_path.empty()) {
    impl->command = command_of("run", file, options);
    impl->command_has_seed = options.seed.has_value();
    impl->command_seed = impl->world->spec().seed;
  }
  return Simulation(std::move(impl));
}

Simulation::Simulation(engine::WorldSpec world, const SimulationOptions& options)
    : Simulation(std::move(world), options, make_registry()) {}

Simulation::Simulation(engine::WorldSpec world, const SimulationOptions& options, engine::Registry registry)
    : Simulation(make(std::move(world), options, std::move(registry))) {}

Simulation Simulation::make(engine::WorldSpec spec, const SimulationOptions& options,
                            engine::Registry registry) {
  if (!options.robots.empty() || !options.set.empty() || !options.search_path.empty())
    throw std::invalid_argument(
        "SimulationOptions: robots, set and search_path apply to world files only; for a WorldSpec, change "
        "its members instead");
  restore_fp_environment();
  auto impl = std::make_unique<Impl>();
  impl->file = spec.title.empty() ? "world" : spec.title;
  impl->registry = std::make_shared<engine::Registry>(std::move(registry));
  impl->plugins = add_plugins(*impl->registry, options.plugin_path, options.scripts);
  Diagnostics diagnostics(spec.files);
  worldio::check_spec(spec, *impl->registry, diagnostics);
  diagnostics.throw_if_errors();
  assign_controllers(options.scripts, spec, diagnostics);
  diagnostics.throw_if_errors();
  if (options.seed) spec.seed = *options.seed;
  impl->start(std::move(spec), options, diagnostics);
  return Simulation(std::move(impl));
}

Simulation::Simulation(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

Simulation Simulation::resume(const std::filesystem::path& file, const ResumeOptions& options) {
  return resume(file, options, make_registry());
}

Simulation Simulation::resume(const std::filesystem::path& file, const ResumeOptions& options,
                              engine::Registry registry) {
  restore_fp_environment();
  const worldio::Checkpoint checkpoint(file);
  auto impl = std::make_unique<Impl>();
  if (const std::optional<std::string> warning = check_version(checkpoint, options.across_versions))
    impl->warnings.push_back(*warning);
  impl->registry = std::make_shared<engine::Registry>(std::move(registry));
  impl->plugins = add_plugins(*impl->registry, options.plugin_path, options.scripts);
  append(impl->warnings, load_plugins(checkpoint, *impl->plugins, options.across_plugins));
  append(impl->warnings, impl->plugins->warnings());
  impl->file = checkpoint.header("world");
  Diagnostics diagnostics;
  std::vector<worldio::ParameterChange> parameters;
  engine::WorldSpec spec = checkpoint.spec(*impl->registry, options.set, diagnostics, parameters);
  diagnostics.throw_if_errors();
  // Warnings about the world were reported when it was loaded, and are not repeated here.
  impl->make_world(std::move(spec), options, diagnostics);
  impl->restore(checkpoint, diagnostics);
  for (const auto& [pointer, setting] : parameters)
    if (const Result<> done = impl->world->set(setting, *impl->registry); !done)
      throw InputError(fmt::format("--set {}: error: {}", pointer, done.error().text));
  for (const auto& [key, value] : checkpoint.header())
    if (key.starts_with("set ") || key == k_spare) impl->changes.emplace_back(key, value);
  for (const auto& [pointer, value] : options.set)
    add_setting(impl->changes, pointer, fmt::format(" at tick {}", checkpoint.tick()), value);
  impl->command = command_of("resume", file, options);
  impl->command_seed = impl->world->spec().seed;
  return Simulation(std::move(impl));
}

/// Returns the bodies of this world with the places that they have with another seed. Throws std::logic_error
/// for a resumed run. call: name of the calling function, for the error.
std::vector<engine::BodySpec> Simulation::bodies_placed_by(std::uint64_t seed, std::string_view call) const {
  if (impl_->resumed_at)
    throw std::logic_error(
        fmt::format("{} needs the rules by which bodies are placed, but this run was resumed from a "
                    "checkpoint, which does not store these rules: start from the world file instead",
                    call));
  restore_fp_environment();  // a library may have changed it: see World::step()
  std::vector<engine::BodySpec> bodies = impl_->world->spec().bodies;
  for (const auto& [body, pose] : impl_->moved_starts) bodies[body].pose_world_body = pose;
  if (impl_->place_again) impl_->place_again(bodies, seed);
  return bodies;
}

Simulation Simulation::another(std::uint64_t seed, unsigned threads) const {
  std::vector<engine::BodySpec> bodies = bodies_placed_by(seed, "another()");
  auto impl = std::make_unique<Impl>();
  impl->registry = impl_->registry;
  impl->plugins = impl_->plugins;
  impl->file = impl_->file;
  impl->tile_size_m = impl_->tile_size_m;
  impl->place_again = impl_->place_again;
  impl->changes = impl_->changes;
  engine::WorldSpec spec = impl_->world->spec();
  spec.experiment.at.resize(spec.experiment.at.size() - impl_->world->interventions().settings_made());
  spec.bodies = std::move(bodies);
  spec.seed = seed;
  Diagnostics diagnostics(spec.files);
  impl->world = std::make_unique<engine::World>(
      std::move(spec), *impl->registry, engine::WorldOptions{threads, impl->tile_size_m}, diagnostics);
  impl->watch_for_the_end(diagnostics);
  return Simulation(std::move(impl));
}

std::optional<std::uint64_t> Simulation::resumed_at_tick() const { return impl_->resumed_at; }

void Simulation::save(const std::filesystem::path& checkpoint) const {
  if (impl_->in_before_tick)
    throw std::logic_error(
        "save() is not allowed in a callback of before_tick(), because a run that is resumed from the "
        "checkpoint would repeat the interventions of this tick: call it between two steps, or in a callback "
        "of on_tick()");
  impl_->world->require_whole();
  Model::require_may_change(*impl_->world, "save()");
  impl_->world->gather();  // the counts in the checkpoint are counts of all robots
  impl_->refuse_to_replace_inputs(checkpoint);
  worldio::require_hdf5_ending(checkpoint);
  worldio::FileHeader header = effective_options();
  header.insert(header.begin(), {"version", version_line()});
  header.emplace_back("title", title());
  if (impl_->recording) impl_->recording->flush();  // a resumed recording must reach the checkpoint's tick
  worldio::Memories memories;
  const auto on_save = impl_->on_save;  // a copy, because a callback may remove itself
  for (const auto& [name, memory] : on_save) memories[name] = memory();
  if (impl_->stop)
    if (std::vector<std::byte> memory = impl_->stop->memory(); !memory.empty())
      memories[k_stop_conditions] = std::move(memory);
  if (!impl_->holds.empty()) memories[k_holds] = impl_->holds.memory();
  worldio::write_checkpoint(checkpoint, *impl_->world, *impl_->registry, header, memories);
}

void Simulation::on_save(const std::string& name, std::function<std::vector<std::byte>()> memory) {
  if (name == k_holds || name.starts_with(k_stop_conditions))
    throw std::invalid_argument(
        fmt::format("on_save(): checkpoints store data of Troupe under \"{}\": choose another name", name));
  Model::require_may_change(*impl_->world, "on_save()");
  if (memory)
    impl_->on_save[name] = std::move(memory);
  else
    impl_->on_save.erase(name);
}

std::optional<std::vector<std::byte>> Simulation::saved_memory(const std::string& name) const {
  const auto found = impl_->memories.find(name);
  return found == impl_->memories.end() ? std::nullopt : std::optional(found->second);
}

std::string Simulation::command(const std::filesystem::path& session) const {
  if (impl_->command.empty()) return {};
  const std::uint64_t seed = impl_->world->spec().seed;  // reset() may have changed it
  const bool needs_seed = impl_->command_has_seed || seed != impl_->command_seed;
  return fmt::format("{}{} --session {}", impl_->command, needs_seed ? fmt::format(" --seed {}", seed) : "",
                     shell_word(session.string()));
}

std::vector<std::pair<std::string, std::string>> Simulation::effective_options() const {
  const engine::WorldSpec& spec = impl_->world->spec();
  std::vector<std::pair<std::string, std::string>> out{
      {"world", impl_->file.string()},
      {"seed", fmt::format("{}", spec.seed)},
      {"tick_s", fmt::format("{}", impl_->world->view().tick_s())},
      {"ranging", std::string(engine::ranging_engine_name(spec.ranging))},
      {"robots", fmt::format("{}", impl_->world->lives().robots_at_start())},
      {"threads", fmt::format("{}", threads())},
      {"tile_m", fmt::format("{}", impl_->world->view().geometry().tile_m())},
      {"simd", partition::simd_target()},
  };
  if (ranks() > 1) out.emplace_back("ranks", fmt::format("{}", ranks()));
  if (spec.ranging == RangingEngine::grid)
    out.emplace_back("resolution_m", fmt::format("{}", spec.resolution_m));
  for (const Plugins::Library& library : impl_->plugins->libraries())
    out.emplace_back(fmt::format("{}{}", k_plugin, library.name), hex(library.contents));
  for (const auto& [key, value] : impl_->changes) out.emplace_back(key, value);
  if (impl_->resumed_at) out.emplace_back("resumed_at_tick", fmt::format("{}", *impl_->resumed_at));
  return out;
}

}  // namespace troupe
