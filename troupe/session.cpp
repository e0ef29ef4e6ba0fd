#include "troupe/session.hpp"

#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "base/result.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "troupe/acts.hpp"
#include "troupe/effective_options.hpp"
#include "troupe/simulation.hpp"
#include "worldio/files.hpp"
#include "worldio/json/session_json.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/results/descriptor.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

namespace troupe {
namespace fs = std::filesystem;
namespace {

std::string value_of(const std::vector<std::pair<std::string, std::string>>& options, std::string_view key) {
  for (const auto& [name, value] : options)
    if (name == key) return value;
  return "not given";
}

/// Returns success if session and simulation have the same options, else an error that lists the options that
/// differ.
Result<> same_options(const worldio::SessionHeader& header, const Simulation& simulation) {
  const std::vector<std::pair<std::string, std::string>> here = simulation.effective_options();
  std::string text;
  const auto compare = [&](const std::string& key) {
    const std::string then = value_of(header.options, key);
    const std::string now = value_of(here, key);
    if (then != now)
      text += fmt::format("{}{} is {} in the session, but {} in this run", text.empty() ? "" : "; ", key,
                          then, now);
  };
  const auto is_free = [](const std::string& key) { return key == "world" || changes_no_result(key); };
  for (const auto& [key, value] : header.options)
    if (!is_free(key)) compare(key);
  for (const auto& [key, value] : here)
    if (!is_free(key) &&
        std::ranges::none_of(header.options, [&k = key](const auto& o) { return o.first == k; }))
      compare(key);
  if (!text.empty()) return Error{text};
  return {};
}

/// Returns the first line of a session that begins at the present state. Throws std::runtime_error if an
/// option, such as the path of the world, is not UTF-8.
std::string header_of(const Simulation& simulation) {
  worldio::SessionHeader header{.version = version_line(),
                                .tick = simulation.tick(),
                                .hash = hex(simulation.state_hash()),
                                .world_hash = hex(worldio::hash_of_content(simulation.world().spec())),
                                .options = simulation.effective_options()};
  try {
    return worldio::header_line(header);
  } catch (const std::invalid_argument&) {
  }
  for (auto& option : std::exchange(header.options, {})) try {
      header.options = {option};
      static_cast<void>(worldio::header_line(header));
    } catch (const std::invalid_argument&) {
      throw std::runtime_error(fmt::format(
          "{}: error: the {} is not UTF-8, which a session file requires: use a name in UTF-8", option.second,
          option.first == "world" ? "path of the world" : "option \"" + option.first + "\""));
    }
  throw std::runtime_error("the version of this program is not UTF-8, which a session file requires");
}

}  // namespace

struct SessionLog::Impl {
  fs::path file;
  int descriptor;
  std::uint64_t acts = 0;
  bool has_begun = false;  // the first line is written
  std::string failure;     // why a write failed; empty: none did

  Impl(fs::path path, int open_file) : file(std::move(path)), descriptor(open_file) {}
  ~Impl() {
    ::close(descriptor);
    std::error_code ignored;
    if (!has_begun) fs::remove(file, ignored);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// Throws std::logic_error unless begin() has been called. Does nothing after a write failed, because
  /// write() then throws. call: name of the calling function, for the error.
  void require_begun(std::string_view call) const {
    if (!has_begun && failure.empty())
      throw std::logic_error(
          fmt::format("{}: error: {} before begin(): a session file begins with the line that begin() writes",
                      file.string(), call));
  }

  /// Appends a line. After an error, part of the line may be in the file, so that no further line is written.
  void write(std::string line) {
    if (!failure.empty()) throw std::runtime_error(failure);
    line += '\n';
    if (worldio::write_all(descriptor, line)) return;
    failure = fmt::format("{}: error: cannot be written: {}", file.string(),
                          std::generic_category().message(errno));
    throw std::runtime_error(failure);
  }
};

SessionLog::SessionLog(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

SessionLog::SessionLog(const fs::path& folder, const Simulation& simulation)
    : impl_(std::move(create(folder, simulation)->impl_)) {
  begin(simulation);
}

std::unique_ptr<SessionLog> SessionLog::create(const fs::path& folder, const Simulation& simulation) {
  static_cast<void>(header_of(simulation));  // before the file is created: throws for an invalid option
  const std::string stem = fs::path(value_of(simulation.effective_options(), "world")).stem().string();
  Result<worldio::NewFile> file = worldio::create_new_file(folder, stem, "session", "jsonl");
  if (!file) throw std::runtime_error(file.error().text);
  return std::unique_ptr<SessionLog>(
      new SessionLog(std::make_unique<Impl>(std::move(file->path), file->descriptor)));
}

SessionLog::~SessionLog() = default;

const fs::path& SessionLog::file() const { return impl_->file; }

void SessionLog::begin(const Simulation& simulation) {
  if (impl_->has_begun)
    throw std::logic_error(fmt::format("{}: error: begin() was called twice: a file contains one session",
                                       impl_->file.string()));
  impl_->write(header_of(simulation));
  impl_->has_begun = true;
}

void SessionLog::add(const Simulation& simulation, const engine::Act& act) {
  impl_->require_begun("add()");
  impl_->write(worldio::act_line(simulation.tick(), ++impl_->acts, act));
}

void SessionLog::end(std::uint64_t tick) {
  impl_->require_begun("end()");
  impl_->write(worldio::end_line(tick, impl_->acts + 1));
}

struct SessionReplay::Impl {
  fs::path file;
  worldio::Session session;
  std::size_t next = 0;

  [[noreturn]] void fail(std::uint32_t line, std::string_view message) const {
    throw InputError(fmt::format("{}:{}: error: {}", file.string(), line, message));
  }
  void check_state(const Simulation& simulation) const {
    const worldio::SessionHeader& header = session.header;
    if (simulation.tick() < header.tick)
      fail(1, fmt::format("the session began at tick {}, from a checkpoint: resume this checkpoint (troupe "
                          "resume CHECKPOINT --session ...)",
                          header.tick));
    if (simulation.tick() > header.tick) return;
    if (!header.world_hash.empty() &&
        header.world_hash != hex(worldio::hash_of_content(simulation.world().spec())))
      fail(1,
           "the session is of another world: a body, a wall, a type, a parameter or an intervention of the "
           "world differs: repeat the session with the world file with which it was recorded");
    if (const std::string hash = hex(simulation.state_hash()); hash != header.hash)
      fail(1,
           fmt::format("the session began at tick {} with state hash {}, but at that tick this run has {}: "
                       "repeat the session with the world file and the options with which it was recorded",
                       header.tick, header.hash, hash));
  }
};

SessionReplay::SessionReplay(const fs::path& file, const Simulation& simulation)
    : impl_(std::make_unique<Impl>()) {
  impl_->file = file;
  impl_->session = worldio::load_session(file);
  const worldio::SessionHeader& header = impl_->session.header;
  const std::string here = version_line();
  if (const std::string_view then = program_of(header.version), now = program_of(here); then != now)
    impl_->fail(1, fmt::format("{} wrote this session, but this program is {}, whose results may differ: use "
                               "the version that wrote it",
                               then, now));
  if (const Result<> same = same_options(header, simulation); !same)
    impl_->fail(1,
                fmt::format("this run has other options than the run of the session: {}", same.error().text));
  const std::uint64_t end = end_tick().value_or(least_end_tick());
  if (const double end_s = static_cast<double>(end) * simulation.tick_s(); end_s > engine::k_longest_run_s)
    impl_->fail(static_cast<std::uint32_t>(impl_->session.acts.size() + (end_tick() ? 2 : 1)),
                fmt::format("tick {} is at {:.10g} s, but a run ends at {} s or earlier", end, end_s,
                            engine::k_longest_run_s));
  impl_->check_state(simulation);
  while (left() > 0 && impl_->session.acts[impl_->next].tick < simulation.tick()) ++impl_->next;
}

SessionReplay::~SessionReplay() = default;

void SessionReplay::act(Simulation& simulation) {
  for (; left() > 0 && impl_->session.acts[impl_->next].tick == simulation.tick(); ++impl_->next) {
    const worldio::LoggedAct& logged = impl_->session.acts[impl_->next];
    try {
      simulation.act(logged.act);
    } catch (const ActRefused& error) {
      impl_->fail(logged.where.line, fmt::format("at tick {}: {}", logged.tick, error.what()));
    }
  }
}

std::optional<std::uint64_t> SessionReplay::end_tick() const { return impl_->session.end; }
std::uint64_t SessionReplay::least_end_tick() const {
  const worldio::Session& session = impl_->session;
  return session.acts.empty() ? session.header.tick : session.acts.back().tick + 1;
}
std::size_t SessionReplay::left() const { return impl_->session.acts.size() - impl_->next; }
const std::vector<std::string>& SessionReplay::warnings() const { return impl_->session.warnings; }

}  // namespace troupe
