#include "live/viewer_files.hpp"

#include "troupe/acts.hpp"
#include "troupe/simulation.hpp"

#include <fmt/format.h>

#include <system_error>

namespace troupe::live {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t k_bytes_gb = 1'000'000'000;
constexpr std::uintmax_t k_most_file_bytes = 10 * k_bytes_gb;  // of all files that viewers request
constexpr int k_most_files = 100000;  // largest number of files of one kind in a folder

}  // namespace

/// Returns the name of a file that does not exist: WORLD.WHAT.h5, else WORLD.WHAT-2.h5, and so on.
fs::path ViewerFiles::new_file(std::string_view what) const {
  if (bytes_ >= k_most_file_bytes)
    throw ActRefused(fmt::format(
        "the files that viewers requested have reached {} GB, the limit of a view: end this view, and start "
        "another one",
        k_most_file_bytes / k_bytes_gb));
  const std::string stem = fs::path(simulation_.effective_options().front().second).stem().string();
  for (int i = 1; i <= k_most_files; ++i) {
    fs::path file =
        folder_ / (i == 1 ? fmt::format("{}.{}.h5", stem, what) : fmt::format("{}.{}-{}.h5", stem, what, i));
    if (!fs::exists(file)) return file;
  }
  throw ActRefused(fmt::format(
      "the folder of the view already has the {0} files {1}.{2}.h5 to {1}.{2}-{0}.h5: move some of them to "
      "another folder",
      k_most_files, stem, what));
}

std::string ViewerFiles::save_checkpoint() {
  const fs::path file = new_file("checkpoint");
  simulation_.save(file);
  bytes_ += fs::file_size(file);
  return file.filename().string();
}

std::string ViewerFiles::start_recording() {
  if (!recording_.empty()) throw ActRefused("the run is being recorded already: stop this recording first");
  const fs::path file = new_file("recording");
  simulation_.record(file);
  recording_ = file;
  return file.filename().string();
}

void ViewerFiles::stop_recording() {
  if (recording_.empty()) return;
  simulation_.stop_recording();
  std::error_code ignored;
  bytes_ += fs::file_size(recording_, ignored);
  recording_.clear();
}

void ViewerFiles::limit_recording() {
  if (recording_.empty()) return;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(recording_, error);
  if (error || bytes_ + size < k_most_file_bytes) return;
  if (report_)
    report_(fmt::format("{}: the recording ends, because the files that viewers requested have reached {} GB",
                        recording_.string(), k_most_file_bytes / k_bytes_gb));
  stop_recording();
}

}  // namespace troupe::live
