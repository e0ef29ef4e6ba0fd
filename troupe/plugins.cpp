#include "troupe/plugins.hpp"

#include "base/diagnostics.hpp"
#include "base/fp_environment.hpp"
#include "base/hash.hpp"
#include "base/split.hpp"
#include "engine/kinds/thrown_text.hpp"
#include "troupe/plugin_library.hpp"
#include "worldio/files.hpp"
#include "worldio/json/kind_checks.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <optional>
#include <stdexcept>

namespace troupe {
namespace fs = std::filesystem;
namespace {

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// Whether the bytes of a library contain the name of a symbol: a cheap test for an export, before loading.
bool mentions(std::string_view library, std::string_view symbol) {
  return library.find(std::string(symbol) + '\0') != library.npos;
}

/// Whether a library contains all of its loadable segments. The dynamic loader does not check this: of a
/// truncated file, it maps pages beyond the end, and reading such a page kills the process.
bool is_whole(std::string_view bytes) {
  const auto read = [&bytes](auto& value, std::size_t offset) {
    if (offset > bytes.size() || bytes.size() - offset < sizeof(value)) return false;
    std::memcpy(&value, bytes.data() + offset, sizeof(value));
    return true;
  };
  ElfW(Ehdr) head;
  if (!read(head, 0)) return false;
  for (std::size_t i = 0; i < head.e_phnum; ++i) {
    ElfW(Phdr) part;
    if (!read(part, head.e_phoff + i * head.e_phentsize)) return false;
    if (part.p_type == PT_LOAD &&
        (part.p_offset > bytes.size() || bytes.size() - part.p_offset < part.p_filesz))
      return false;
  }
  return true;
}

/// Returns success if the bytes of a file look like a plug-in, else an error whose text continues a sentence
/// that begins with the file name. Call it before loading the file, because loading runs code of the file.
Result<> check_contents(std::string_view bytes) {
  if (!bytes.starts_with("\177ELF"))
    return Error{"is not a shared library: build it with the CMake target troupe::plugin"};
  if (!is_whole(bytes)) return Error{"is truncated: build it again"};
  if (mentions(bytes, plugin::k_symbol)) return {};
  if (mentions(bytes, "Init"))
    return Error{
        fmt::format("is a controller of Stage (it has Init, but not {}), which Troupe cannot run; "
                    "docs/controllers.md shows how to write one for Troupe",
                    plugin::k_symbol)};
  return Error{
      fmt::format("is not a Troupe plug-in: it has no symbol {}, which the macros TROUPE_CONTROLLER, "
                  "TROUPE_DEVICE and TROUPE_MEASURE define",
                  plugin::k_symbol)};
}

/// Returns success if a loaded library was built for this program. Reads the other members only after
/// `interface` and `version` have been compared, because only these two have the same offsets in every
/// version.
Result<> check_build(const plugin::Library& library) {
  if (library.interface != plugin::k_interface || std::string_view(library.version) != k_version)
    return Error{fmt::format(
        "was built for troupe {} (interface {}), but this program is troupe {} (interface {}): rebuild it",
        library.version, library.interface, k_version, plugin::k_interface)};
  if (std::string_view(library.build) != plugin::k_build)
    return Error{
        fmt::format("was built with {}, but Troupe with {}: link it with the CMake target troupe::plugin, "
                    "which sets the flags, and compile it without flags that change the layout of types",
                    library.build, plugin::k_build)};
  if (library.layout != plugin::layout())
    return Error{fmt::format("was built with other headers of troupe {}: rebuild it", k_version)};
  if (library.contracts())
    return Error{
        "was compiled with fused multiply-add (a * b + c is rounded once), which changes results: link it "
        "with the CMake target troupe::plugin, which sets -ffp-contract=off"};
  return {};
}

/// Whether a name has the form of names of kinds in plug-ins: "dancer" or "swarm:leader".
bool may_be_kind(std::string_view name) {
  const std::size_t colon = name.find(':');
  return plugin::is_name(name.substr(0, colon)) &&
         (colon == name.npos || plugin::is_name(name.substr(colon + 1)));
}

/// Returns the error of dlerror() for the library `file`, `cannot be loaded: undefined symbol: ...`, without
/// the file name, which callers add.
Error load_error(const fs::path& file) {
  const char* said = dlerror();
  std::string_view reason = said ? said : "the system gives no reason";
  const std::string prefix = file.string() + ": ";
  if (reason.starts_with(prefix)) reason.remove_prefix(prefix.size());
  return {fmt::format(
      "cannot be loaded: {}{}", reason,
      reason.find("N6troupe") == reason.npos ? "" : " (link it with the CMake target troupe::plugin)")};
}

}  // namespace

struct Plugins::Kinds {
  std::vector<engine::ControllerKind> controllers;
  std::vector<engine::DeviceKind> devices;
  std::vector<engine::MeasureKind> measures;
};

/// The names of the controllers, of the devices or of the measures of a library.
struct Plugins::KindNames {
  std::string_view what;          ///< "controller", "measure" or "sensor or device", for error messages
  bool is_in_scripts = true;      ///< whether scripts may contain kinds of this group
  std::deque<std::string> names;  ///< names of the kinds; a deque, because the kinds refer to them
  std::vector<std::string_view> known() const { return {names.begin(), names.end()}; }
};

template <class K>
struct Plugins::Group : KindNames {
  std::vector<K> kinds;  ///< in the order of the names
};

struct Plugins::Loaded : Library {
  Result<> found;   ///< success if the file exists; the error lists the searched folders
  Result<> opened;  ///< success if the found library can be used; the error states why it cannot
  bool is_usable() const { return found && opened; }
  /// Returns the error of `found`, with the remedy for the case that the library is a script.
  std::string missing_script() const {
    return fmt::format(
        "{}; if it is a Python script, give --controller {}.py (in Python: controllers=[\"{}.py\"])",
        found.error().text, name, name);
  }

  Group<engine::ControllerKind> controllers{{"controller"}, {}};
  Group<engine::DeviceKind> devices{{"sensor or device", false}, {}};
  Group<engine::MeasureKind> measures{{"measure"}, {}};
  std::shared_ptr<const Script> script;  ///< the owner of the kinds, if the library is a script
  /// Names of the kinds of all groups, sorted.
  std::vector<std::string_view> known() const {
    std::vector<std::string_view> names = controllers.known();
    for (const std::string_view name_of_device : devices.known()) names.push_back(name_of_device);
    for (const std::string_view name_of_measure : measures.known()) names.push_back(name_of_measure);
    std::ranges::sort(names);
    return names;
  }
  /// Returns the index of the kind `kind` of a group of this library. unknown: see controller()
  Result<std::size_t> index_of(std::string_view kind, const KindNames& own, std::string_view unknown) const;
};

Plugins::Plugins(std::vector<fs::path> path, const engine::Registry& registry) : path_(std::move(path)) {
  for (const std::string_view name : registry.controller_names()) taken_controllers_.emplace_back(name);
  for (const engine::DeviceKind& kind : registry.devices) taken_devices_.emplace_back(kind.name);
  for (const engine::MeasureKind& kind : registry.measures) taken_measures_.emplace_back(kind.name);
}
Plugins::~Plugins() = default;

Result<const engine::ControllerKind*> Plugins::controller(std::string_view name, std::string unknown) {
  return find(name, &Loaded::controllers, std::move(unknown));
}

Result<const engine::DeviceKind*> Plugins::device(std::string_view name, std::string unknown) {
  return find(name, &Loaded::devices, std::move(unknown));
}

Result<const engine::MeasureKind*> Plugins::measure(std::string_view name, std::string unknown) {
  return find(name, &Loaded::measures, std::move(unknown));
}

template <class K>
Result<const K*> Plugins::find(std::string_view name, Group<K> Loaded::*group, std::string unknown) {
  if (!may_be_kind(name)) return Error{std::move(unknown)};
  const std::scoped_lock lock(mutex_);
  const Loaded& library = loaded(name.substr(0, name.find(':')));
  const Group<K>& own = library.*group;
  const Result<std::size_t> index = library.index_of(name, own, unknown);
  if (!index) return index.error();
  return &own.kinds[*index];
}

Result<std::size_t> Plugins::Loaded::index_of(std::string_view kind, const KindNames& own,
                                              std::string_view unknown) const {
  if (!found)
    return Error{fmt::format("{}; {}", unknown, own.is_in_scripts ? missing_script() : found.error().text)};
  if (!opened) return Error{fmt::format("{} \"{}\": {}", own.what, kind, opened.error().text)};
  const std::size_t colon = kind.find(':');
  const std::string_view own_name = colon == kind.npos ? kind : kind.substr(colon + 1);
  const std::vector<std::string_view> names = own.known();
  const auto index = std::ranges::find(names, own_name == name ? own_name : kind);
  if (index != names.end()) return static_cast<std::size_t>(index - names.begin());
  return Error{fmt::format(
      "{} has no {} \"{}\"; it has: {}{}", file.string(), own.what, kind,
      names.empty() ? fmt::format("{}, but no {}", comma_list(known()), own.what) : comma_list(names),
      did_you_mean(kind, names))};
}

std::string Plugins::unknown_kind(std::string_view name, std::string unknown) {
  if (!may_be_kind(name)) return unknown;
  const std::scoped_lock lock(mutex_);
  const Loaded& library = loaded(name.substr(0, name.find(':')));
  if (!library.found) return fmt::format("{}; {}", unknown, library.missing_script());
  if (!library.opened) return library.opened.error().text;
  const std::vector<std::string_view> known = library.known();
  return fmt::format("{} has no kind \"{}\"; it has: {}{}", library.file.string(), name, comma_list(known),
                     did_you_mean(name, known));
}

Result<const Plugins::Library*> Plugins::load(std::string_view name, bool may_be_script) {
  if (!plugin::is_name(name))
    return Error{fmt::format(
        "\"{}\" is not a valid name of a plug-in: give one word that does not begin with a dot and contains "
        "none of : = / \\ and quotation marks",
        name)};
  const std::scoped_lock lock(mutex_);
  const Loaded& library = loaded(name);
  if (!library.found) return may_be_script ? Error{library.missing_script()} : library.found.error();
  if (!library.opened) return library.opened.error();
  return &library;
}

std::vector<Plugins::Library> Plugins::libraries() const {
  std::vector<Library> in_use;
  const std::scoped_lock lock(mutex_);
  for (const auto& [name, library] : loaded_)
    if (library->is_usable()) in_use.push_back(*library);
  return in_use;
}

std::vector<std::string> Plugins::warnings() const {
  const std::scoped_lock lock(mutex_);
  return warnings_;
}

/// Adds an empty library of this name.
Plugins::Loaded& Plugins::add_library(std::string_view name) {
  Loaded& library = *loaded_.emplace(name, std::make_unique<Loaded>()).first->second;
  library.name = name;
  return library;
}

/// Returns the library of this name. The first call with a name searches the folders and opens the file.
Plugins::Loaded& Plugins::loaded(std::string_view name) {
  if (const auto known = loaded_.find(name); known != loaded_.end()) return *known->second;
  Loaded& library = add_library(name);
  const std::string file_name = library.name + ".so";
  for (const fs::path& folder : path_)
    if (library.file.empty() && is_file(folder / file_name)) library.file = folder / file_name;
  if (!library.file.empty()) {
    if (const Result<> opened = open(library); !opened)
      library.opened = Error{fmt::format("{} {}", library.file.string(), opened.error().text)};
    return library;
  }
  if (path_.empty()) {
    library.found = Error{fmt::format(
        "no folder to search for {}: give --plugin-path (in C++ and Python: plugin_path)", file_name)};
    return library;
  }
  std::vector<std::string> folders;
  for (const fs::path& folder : path_) folders.push_back(folder.string());
  std::string missing = fmt::format("there is no {} in {}", file_name, joined(folders, ", "));
  for (const fs::path& folder : path_)
    if (is_file(folder / ("lib" + file_name)))
      missing += fmt::format(" (the file name of a plug-in does not begin with \"lib\": rename {})",
                             (folder / ("lib" + file_name)).string());
  for (const fs::path& folder : path_)
    if (is_file(folder))
      missing += fmt::format(" ({} is a file: give the folder that contains it)", folder.string());
  library.found = Error{std::move(missing)};
  return library;
}

/// Loads the file of a library and stores its kinds in `library`. The error states why the library cannot be
/// used.
Result<> Plugins::open(Loaded& library) {
  const std::optional<std::string> bytes = worldio::read_file(library.file);
  if (!bytes) return Error{"cannot be read"};
  if (Result<> ours = check_contents(*bytes); !ours) return ours;
  library.contents = hash_text(*bytes);

  const fs::path absolute = fs::absolute(library.file);  // dlopen() would search a bare name in other folders
  const bool was_right = static_cast<bool>(check_fp_environment());
  void* const handle = dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (const Result<> is_right = check_fp_environment(); was_right && !is_right) {
    restore_fp_environment();
    warnings_.push_back(
        fmt::format("{}: warning: this plug-in was linked with -ffast-math, which changed the arithmetic of "
                    "the thread that loaded the plug-in ({}); Troupe has restored the arithmetic",
                    library.file.string(), is_right.error().text));
  }
  if (!handle) return load_error(absolute);
  const auto symbol = reinterpret_cast<plugin::Symbol>(dlsym(handle, plugin::k_symbol));
  if (!symbol) return Error{fmt::format("is not a Troupe plug-in: it has no symbol {}", plugin::k_symbol)};
  // From here on code of the plug-in runs, which may throw anything.
  try {
    const plugin::Library* const described = symbol();
    if (!described) return Error{fmt::format("cannot be used: {} returns null", plugin::k_symbol)};
    if (Result<> fits = check_build(*described); !fits) return fits;
    std::uint64_t before = 0;
    if (!described->contents->compare_exchange_strong(before, library.contents) && before != library.contents)
      return Error{"was rebuilt since this process loaded it: restart the process"};
    Kinds kinds;
    described->list(kinds.controllers, kinds.devices, kinds.measures);
    return keep_kinds(library, std::move(kinds));
  } catch (...) {
    return Error{
        fmt::format("cannot be used: its code that registers controllers, sensors, devices and measures {}",
                    engine::thrown_text())};
  }
}

Result<> Plugins::keep_kinds(Loaded& library, Kinds all) const {
  Result<> all_right;
  const auto keep = [&](auto kinds, const std::vector<std::string>& taken, auto& own) {
    // By name, because the linker's order is arbitrary. Sorting the kinds themselves would instantiate the
    // sorting functions for each type of kind.
    std::vector<std::pair<std::string_view, std::size_t>> order;
    for (const auto& kind : kinds) order.emplace_back(kind.name, order.size());
    std::ranges::sort(order);
    for (const auto& [own_name, index] : order) {
      auto& kind = kinds[index];
      std::string name(own_name);
      if (name != library.name) name = fmt::format("{}:{}", library.name, name);
      if (const Result<> checked = worldio::check_kind(kind); !checked)
        all_right = Error{fmt::format("has a {} \"{}\" that {}", own.what, name, checked.error().text)};
      if (std::ranges::find(taken, name) != taken.end())
        all_right = Error{
            fmt::format("has a {} \"{}\", but Troupe ships one with this name: rename it", own.what, name)};
      if constexpr (requires { kind.prepare; })  // measures have no components
        if (const Result<> named = worldio::check_kind_name(name); !named)
          all_right = Error{fmt::format("has a {} \"{}\" that {}", own.what, name, named.error().text)};
      kind.name = own.names.emplace_back(std::move(name));
      own.kinds.push_back(std::move(kind));
    }
    if (Result<> different = worldio::check_different(own.known(), own.what); !different)
      all_right = std::move(different);
  };
  keep(std::move(all.controllers), taken_controllers_, library.controllers);
  keep(std::move(all.devices), taken_devices_, library.devices);
  keep(std::move(all.measures), taken_measures_, library.measures);
  if (library.controllers.kinds.empty() && library.devices.kinds.empty() && library.measures.kinds.empty())
    all_right = Error{
        "registers no controller, sensor, device or measure: register one with "
        "TROUPE_CONTROLLER, TROUPE_DEVICE (also for sensors) or TROUPE_MEASURE"};
  return all_right;
}

void Plugins::add(std::shared_ptr<const Script> script) {
  const std::string name = script->name();
  if (!plugin::is_name(name))
    throw InputError(fmt::format(
        "{}: error: the script has the name \"{}\", but its name must be one word that does not begin with a "
        "dot and contains none of : = / \\ and quotation marks: rename the file",
        script->file.string(), name));
  const std::scoped_lock lock(mutex_);
  if (loaded_.contains(name))
    throw InputError(fmt::format("{}: error: another script or plug-in is also called \"{}\": rename one",
                                 script->file.string(), name));
  Loaded& library = add_library(name);
  library.file = script->file;
  library.contents = script->contents;
  Kinds kinds;
  for (const Script::Controller& controller : script->controllers)
    kinds.controllers.push_back(controller.kind);
  kinds.measures = script->measures;
  library.script = std::move(script);
  if (const Result<> kept = keep_kinds(library, std::move(kinds)); !kept)
    throw InputError(fmt::format("{}: error: it {}", library.file.string(), kept.error().text));
}

std::shared_ptr<Plugins> add_plugins(engine::Registry& registry, std::vector<fs::path> path,
                                     std::span<const std::shared_ptr<const Script>> scripts) {
  if (const Result<> kinds = worldio::check_kinds(registry); !kinds)
    throw std::invalid_argument(kinds.error().text);
  auto plugins = std::make_shared<Plugins>(std::move(path), registry);
  for (std::size_t i = 0; i < scripts.size(); ++i) {
    if (!scripts[i])
      throw std::invalid_argument(
          fmt::format("the script {} of the option scripts (counted from 0) is null: give a script", i));
    plugins->add(scripts[i]);
  }
  registry.plugged_controllers = [plugins](std::string_view name, std::string unknown) {
    return plugins->controller(name, std::move(unknown));
  };
  registry.plugged_devices = [plugins](std::string_view name, std::string unknown) {
    return plugins->device(name, std::move(unknown));
  };
  registry.plugged_measures = [plugins](std::string_view name, std::string unknown) {
    return plugins->measure(name, std::move(unknown));
  };
  return plugins;
}

}  // namespace troupe
