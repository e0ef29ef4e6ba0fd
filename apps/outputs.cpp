#include "apps/outputs.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const fs::path& file, std::string_view reason) {
  throw OutputError(fmt::format("{}: error: cannot be written: {}", file.string(), reason));
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  // Made absolute first: weakly_canonical leaves a relative name that does not exist yet as it is.
  return fs::weakly_canonical(fs::absolute(a, ignored), ignored) ==
         fs::weakly_canonical(fs::absolute(b, ignored), ignored);
}

void check_output(const fs::path& file) {
  std::error_code ignored;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (!fs::is_directory(folder, ignored)) refuse(file, fmt::format("there is no folder {}", folder.string()));
  if (fs::is_directory(file, ignored)) refuse(file, "it is a folder");
  const fs::path& written = fs::exists(file, ignored) ? file : folder;
  if (access(written.c_str(), W_OK) != 0) refuse(file, std::strerror(errno));
}

}  // namespace

void check_outputs(const fs::path& world, const std::vector<fs::path>& outputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    if (output->empty()) continue;
    check_output(*output);
    if (same_file(*output, world)) refuse(*output, "it is the world");
    for (auto other = outputs.begin(); other != output; ++other)
      if (!other->empty() && same_file(*output, *other)) refuse(*output, "another output has the same name");
  }
}

void rehearse_snapshot(const Simulation& simulation, const fs::path& png) {
  const fs::path thumbnail = fs::path(png).concat(fmt::format(".{}.png", getpid()));
  simulation.snapshot(thumbnail, 16, 16);
  std::error_code ignored;
  fs::remove(thumbnail, ignored);
}

HashLog::HashLog(const fs::path& file, const Simulation& simulation) : file_(file), stream_(file) {
  if (!stream_) refuse(file, std::strerror(errno));
  stream_ << simulation.hash_log_header();
}

void HashLog::observe(const Simulation& simulation) {
  stream_ << simulation.hash_log_line() << '\n' << std::flush;
  if (!stream_)
    throw std::runtime_error(fmt::format("{}: error: writing failed at tick {}: {}", file_.string(),
                                         simulation.tick(), std::strerror(errno)));
}

}  // namespace troupe::apps
