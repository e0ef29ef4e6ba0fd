#include "apps/observers/hash_log.hpp"

#include "apps/hash_log_reader.hpp"
#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "troupe/effective_options.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <system_error>
#include <utility>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

/// Returns the number of bytes in the first `lines` lines of a file, with their line breaks.
std::uintmax_t bytes_of_lines(const fs::path& file, std::size_t lines) {
  std::ifstream stream(file, std::ios::binary);
  std::uintmax_t bytes = 0;
  std::string line;
  for (std::size_t i = 0; i < lines && std::getline(stream, line); ++i) bytes += line.size() + 1;
  return bytes;
}

/// Throws OutputError if the log belongs to another run.
void check_same_run(const HashLogReader& log, const Simulation& simulation) {
  const auto& entries = log.header().entries;
  const auto value_of = [&](const std::string& key) {
    const auto header = entries.find(key);
    return header == entries.end() ? nullptr : &header->second.value;
  };
  if (const auto other = option_of_other_run(simulation.effective_options(), value_of)) {
    const auto header = entries.find(other->key);
    throw OutputError(
        fmt::format("{}:{}: error: {} is {}, but \"{}\" in the checkpoint: the log belongs to another run; "
                    "choose another file",
                    log.file().string(), header == entries.end() ? 1 : header->second.line, other->key,
                    other->in_file, other->here));
  }
}

/// Returns the number of bytes in the lines of a hash log up to the current tick of the simulation. The
/// resumed run computes the later ticks again. Throws OutputError if the log does not contain this tick or
/// belongs to another run.
std::uintmax_t bytes_to_tick(const fs::path& file, const Simulation& simulation) {
  HashLogReader log(file);
  check_same_run(log, simulation);
  std::optional<HashLogReader::Line> line = log.next();
  while (line && line->tick < simulation.tick()) line = log.next();
  if (!line)
    throw OutputError(fmt::format(
        "{}: error: the log ends before tick {}, at which the checkpoint was saved: choose another file",
        file.string(), simulation.tick()));
  if (line->tick != simulation.tick())
    throw OutputError(fmt::format(
        "{}: error: the log begins after tick {}, at which the checkpoint was saved: choose another file",
        file.string(), simulation.tick()));
  if (line->text != simulation.hash_log_line())
    throw OutputError(
        fmt::format("{}:{}: error: the state at tick {} differs from the checkpoint: the log belongs to "
                    "another run; choose another file",
                    file.string(), line->number, line->tick));
  return bytes_of_lines(file, line->number);
}

}  // namespace

HashLog::HashLog(const fs::path& file, const Simulation& simulation) : file_(file) {
  std::error_code ignored;
  if (!simulation.resumed_at_tick() || !fs::is_regular_file(file, ignored)) {
    header_ = simulation.hash_log_header();
    return;
  }
  whole_bytes_ = bytes_to_tick(file, simulation);
  written_ = simulation.tick();
}

void HashLog::open() {
  lock_ = open_output(stream_, file_, header_.empty() ? std::optional(whole_bytes_) : std::nullopt);
  stream_ << header_;
}

void HashLog::observe(const Simulation& simulation) {
  if (written_ == simulation.tick()) return;
  const std::string line = simulation.hash_log_line() + '\n';
  stream_ << line << std::flush;
  if (!stream_) throw_write_error(stream_, file_, whole_bytes_, simulation.tick());
  whole_bytes_ += std::exchange(header_, {}).size() + line.size();
}

namespace {

class HashLogOutput : public FileOutput<HashLogOutput> {
 public:
  void add_options(CLI::App& app, RunOptions&) override {
    add_value(app, "--hash-log", "FILE", "Write the hash of the state, one line per tick",
              [this](const std::string& text) { file_ = file_name("--hash-log", text); });
  }
  OpenOutput prepare(const RunOptions&, Simulation& simulation, std::uint64_t) const override {
    if (file_.empty()) return nullptr;
    check_lines_file(file_, simulation, {.name = "a hash log (--hash-log)", .mark = k_hash_log_mark});
    return opening(std::make_unique<HashLog>(file_, simulation));
  }
};

}  // namespace

std::unique_ptr<RunOutput> hash_log_output() { return std::make_unique<HashLogOutput>(); }

}  // namespace troupe::apps
