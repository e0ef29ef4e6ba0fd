#include "troupe/plugins.hpp"

#include "base/diagnostics.hpp"
#include "base/fp_environment.hpp"
#include "base/hash.hpp"
#include "engine/kind_errors.hpp"
#include "troupe/plugin_library.hpp"
#include "worldio/files.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <link.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <optional>

namespace troupe {
namespace fs = std::filesystem;
namespace {

bool is_file(const fs::path& path) {
  std::error_code fault;
  return fs::is_regular_file(path, fault);
}

/// Whether a library exports a symbol of this name, or at least seems to: whether its bytes hold the name.
bool mentions(std::string_view library, std::string_view symbol) {
  return library.find(std::string(symbol) + '\0') != library.npos;
}

/// Whether a library holds all that is to be loaded of it. The system takes that on trust: it maps what is
/// not there, and the process dies when it is read.
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

/// Why a file is not loaded at all: loading runs code of it. Empty where it may be.
std::string why_not_ours(std::string_view bytes) {
  if (!bytes.starts_with("\177ELF")) return "is no shared library";
  if (!is_whole(bytes)) return "is cut off";
  if (mentions(bytes, plugin::k_symbol)) return {};
  if (mentions(bytes, "Init"))
    return fmt::format(
        "is a controller of Stage (it has Init, and no {}): these are written against Stage itself; "
        "docs/controllers.md tells how to write one for Troupe",
        plugin::k_symbol);
  return fmt::format(
      "is no plug-in of Troupe: it has no symbol {}, which TROUPE_CONTROLLER and TROUPE_DEVICE make",
      plugin::k_symbol);
}

/// Why what was loaded cannot be used. Only what stands first in every version is read before that is known.
std::string why_unlike(const plugin::Library& library) {
  if (library.interface != plugin::k_interface || std::string_view(library.version) != k_version)
    return fmt::format(
        "was built for troupe {} (interface {}), this is troupe {} (interface {}): build it again",
        library.version, library.interface, k_version, plugin::k_interface);
  if (std::string_view(library.build) != plugin::k_build)
    return fmt::format(
        "was built with {}, Troupe with {}: link it with troupe::plugin, which brings the flags",
        library.build, plugin::k_build);
  if (library.layout != plugin::layout())
    return fmt::format("was built with the headers of another state of troupe {}: build it again", k_version);
  if (library.contracts())
    return "was compiled so that a * b + c is rounded once, which gives other bits: link it with "
           "troupe::plugin, which brings -ffp-contract=off";
  return {};
}

/// `cannot be loaded: undefined symbol: ...`. The system's words name the file once more.
std::string why_not_loaded(const fs::path& file) {
  const char* said = dlerror();
  std::string_view reason = said ? said : "for no reason that the system tells";
  const std::string prefix = file.string() + ": ";
  if (reason.starts_with(prefix)) reason.remove_prefix(prefix.size());
  return fmt::format("cannot be loaded: {}{}", reason,
                     reason.find("N6troupe") == reason.npos ? "" : " (link it with troupe::plugin)");
}

}  // namespace

struct Plugins::Loaded : Library {
  std::string missing;  ///< there is no such file: where it was looked for
  std::string broken;   ///< it cannot be used: why
  bool is_usable() const { return missing.empty() && broken.empty(); }

  template <class K>
  struct Kinds {
    using Kind = K;
    std::string_view what;  ///< they are, for people
    std::vector<Kind> kinds;
    std::deque<std::string> names;  ///< of the kinds, which keep references
    std::vector<std::string_view> known() const { return {names.begin(), names.end()}; }
  };
  Kinds<engine::ControllerKind> controllers{"controller"};
  Kinds<engine::DeviceKind> devices{"sensor or device"};
  /// What it has, where that is not what was asked for.
  std::string has_else() const {
    return controllers.names.empty()
               ? fmt::format("no controller, but {}", comma_list(devices.known()))
               : fmt::format("no sensor or device, but {}", comma_list(controllers.known()));
  }
};

Plugins::Plugins(std::vector<fs::path> path, const engine::Registry& registry) : path_(std::move(path)) {
  for (const std::string_view name : registry.controller_names()) taken_controllers_.emplace_back(name);
  for (const engine::DeviceKind& kind : registry.devices) taken_devices_.emplace_back(kind.name);
}
Plugins::~Plugins() = default;

const engine::ControllerKind* Plugins::controller(std::string_view name, std::string& fault) {
  return find(name, &Loaded::controllers, fault);
}

const engine::DeviceKind* Plugins::device(std::string_view name, std::string& fault) {
  return find(name, &Loaded::devices, fault);
}

template <class Kinds>
auto Plugins::find(std::string_view name, Kinds Loaded::*kinds, std::string& fault) -> const
    typename Kinds::Kind* {
  const std::size_t colon = name.find(':');
  const std::string_view library_name = name.substr(0, colon);
  const std::string_view own_name = colon == name.npos ? name : name.substr(colon + 1);
  if (!plugin::is_name(library_name) || !plugin::is_name(own_name)) return nullptr;
  Loaded& library = loaded(library_name);
  if (!library.missing.empty()) fault += "; " + library.missing;
  const Kinds& own = library.*kinds;
  if (!library.broken.empty()) fault = fmt::format("{} \"{}\": {}", own.what, name, library.broken);
  if (!library.is_usable()) return nullptr;

  const std::string full_name = own_name == library_name ? std::string(own_name) : std::string(name);
  const auto kind = std::ranges::find(own.kinds, std::string_view(full_name), &Kinds::Kind::name);
  if (kind != own.kinds.end()) return &*kind;
  const std::vector<std::string_view> known = own.known();
  fault = fmt::format("{} has no {} \"{}\"; it has: {}{}", library.file.string(), own.what, name,
                      known.empty() ? library.has_else() : comma_list(known), did_you_mean(name, known));
  return nullptr;
}

const Plugins::Library* Plugins::load(std::string_view name, std::string& fault) {
  if (!plugin::is_name(name)) {
    fault = fmt::format("\"{}\" is no name of a plug-in", name);
    return nullptr;
  }
  const Loaded& library = loaded(name);
  if (library.is_usable()) return &library;
  fault = library.missing + library.broken;
  return nullptr;
}

std::vector<Plugins::Library> Plugins::libraries() const {
  std::vector<Library> in_use;
  for (const auto& library : loaded_)
    if (library->is_usable()) in_use.push_back(*library);
  std::ranges::sort(in_use, {}, &Library::name);
  return in_use;
}

/// What is known of a library, found out once.
Plugins::Loaded& Plugins::loaded(std::string_view name) {
  for (const auto& library : loaded_)
    if (library->name == name) return *library;
  Loaded& library = *loaded_.emplace_back(std::make_unique<Loaded>());
  library.name = name;
  const std::string file_name = library.name + ".so";
  for (const fs::path& folder : path_)
    if (library.file.empty() && is_file(folder / file_name)) library.file = folder / file_name;
  if (!library.file.empty()) {
    open(library);
    if (!library.broken.empty()) library.broken = fmt::format("{} {}", library.file.string(), library.broken);
    return library;
  }
  if (path_.empty()) {
    library.missing = fmt::format("no --plugin-path says where to look for {}", file_name);
    return library;
  }
  std::vector<std::string> folders;
  for (const fs::path& folder : path_) folders.push_back(folder.string());
  library.missing = fmt::format("there is no {} in {}", file_name, fmt::join(folders, ", "));
  for (const fs::path& folder : path_)
    if (is_file(folder / ("lib" + file_name)))
      library.missing +=
          fmt::format(" (a plug-in's name has no \"lib\": {})", (folder / ("lib" + file_name)).string());
  return library;
}

void Plugins::open(Loaded& library) {
  const std::optional<std::string> bytes = worldio::read_file(library.file);
  library.broken = bytes ? why_not_ours(*bytes) : "cannot be read";
  if (!library.broken.empty()) return;
  library.contents = hash_text(*bytes);

  const fs::path absolute = fs::absolute(library.file);  // a bare name would be looked for elsewhere
  const bool was_right = fp_environment_fault().empty();
  void* const handle = dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (const std::string fault = fp_environment_fault(); was_right && !fault.empty()) {
    restore_fp_environment();
    warnings_.push_back(
        fmt::format("{}: warning: was linked with -ffast-math, which changed the arithmetic of the thread "
                    "that loaded it ({}); it "
                    "was changed back",
                    library.file.string(), fault));
  }
  if (!handle) {
    library.broken = why_not_loaded(absolute);
    return;
  }
  const auto symbol = reinterpret_cast<plugin::Symbol>(dlsym(handle, plugin::k_symbol));
  if (!symbol) {
    library.broken = fmt::format("is no plug-in of Troupe: it has no symbol {}", plugin::k_symbol);
    return;
  }
  // From here on code of the plug-in's author runs, which may throw anything.
  try {
    const plugin::Library* const described = symbol();
    library.broken =
        described ? why_unlike(*described) : fmt::format("cannot be used: {} returns null", plugin::k_symbol);
    if (!library.broken.empty()) return;
    std::uint64_t before = 0;
    if (!described->contents->compare_exchange_strong(before, library.contents) &&
        before != library.contents) {
      library.broken = "was built again since this process loaded it: start it again";
      return;
    }
    read_kinds(library, described->list);
  } catch (...) {
    library.broken = fmt::format("cannot say what it holds: it {}", engine::thrown_text());
  }
}

void Plugins::read_kinds(Loaded& library, List list) const {
  std::vector<engine::ControllerKind> controllers;
  std::vector<engine::DeviceKind> devices;
  list(controllers, devices);
  const auto keep = [&library](auto kinds, const std::vector<std::string>& taken, auto& own) {
    std::ranges::sort(kinds, {}, [](const auto& kind) { return kind.name; });  // the linker's order before
    for (auto& kind : kinds) {
      std::string name(kind.name);
      if (name != library.name) name = fmt::format("{}:{}", library.name, name);
      if (!kind.prepare) library.broken = fmt::format("has a {} \"{}\" without `prepare`", own.what, name);
      if (std::ranges::find(own.names, name) != own.names.end())
        library.broken = fmt::format("has two of the name \"{}\", each a {}", name, own.what);
      if (std::ranges::find(taken, name) != taken.end())
        library.broken =
            fmt::format("has a {} \"{}\", a name that Troupe's own has: give it another", own.what, name);
      kind.name = own.names.emplace_back(std::move(name));
    }
    own.kinds = std::move(kinds);
  };
  keep(std::move(controllers), taken_controllers_, library.controllers);
  keep(std::move(devices), taken_devices_, library.devices);
  if (library.controllers.kinds.empty() && library.devices.kinds.empty())
    library.broken = "has no controller, sensor or device";
}

std::shared_ptr<Plugins> add_plugins(engine::Registry& registry, std::vector<fs::path> path) {
  auto plugins = std::make_shared<Plugins>(std::move(path), registry);
  registry.plugged_controllers = [plugins](std::string_view name, std::string& fault) {
    return plugins->controller(name, fault);
  };
  registry.plugged_devices = [plugins](std::string_view name, std::string& fault) {
    return plugins->device(name, fault);
  };
  return plugins;
}

}  // namespace troupe
