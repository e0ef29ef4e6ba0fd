#include "live/viewer_files.hpp"

#include "troupe/acts.hpp"
#include "troupe/simulation.hpp"
#include "worldio/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <exception>
#include <system_error>

namespace troupe::live {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t k_bytes_gb = 1'000'000'000;
constexpr std::uintmax_t k_most_file_bytes = 10 * k_bytes_gb;  // of all files that viewers request
constexpr unsigned k_most_files = 1000;

/// Returns the size of a file; 0 if the file does not exist any more.
std::uintmax_t size_of(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

/// Removes the file of a checkpoint or recording that could not be written, unless the file was completed.
class Reserved {
 public:
  explicit Reserved(fs::path file) : file_(std::move(file)) {}
  ~Reserved() {
    std::error_code ignored;
    if (!is_kept_) fs::remove(file_, ignored);
  }
  Reserved(const Reserved&) = delete;
  Reserved& operator=(const Reserved&) = delete;
  void keep() { is_kept_ = true; }

 private:
  fs::path file_;
  bool is_kept_ = false;
};

}  // namespace

/// Throws ActRefused if the files have reached one of their limits.
void ViewerFiles::check_limit() const {
  if (bytes_ < k_most_file_bytes && files_ < k_most_files) return;
  throw ActRefused(
      fmt::format("the files that viewers requested have reached {}, the limit of a view: end this view, and "
                  "start another "
                  "one",
                  files_ < k_most_files ? fmt::format("{} GB", k_most_file_bytes / k_bytes_gb)
                                        : fmt::format("the number {}", k_most_files)));
}

void ViewerFiles::add_session() {
  check_limit();
  ++files_;
}

/// Creates an empty file WORLD.WHAT.h5, or WORLD.WHAT-2.h5, and so on, and returns its path.
fs::path ViewerFiles::new_file(std::string_view what) {
  check_limit();
  const std::string stem = fs::path(simulation_.effective_options().front().second).stem().string();
  const Result<worldio::NewFile> file = worldio::create_new_file(folder_, stem, what, "h5");
  if (!file) throw ActRefused(file.error().text);
  ::close(file->descriptor);
  ++files_;
  return file->path;
}

std::string ViewerFiles::save_checkpoint() {
  // A recording of a run that is resumed from the checkpoint must reach the tick of the checkpoint.
  use_recording([](Recording& recording) { recording.flush(); });
  const fs::path file = new_file("checkpoint");
  Reserved reserved(file);
  simulation_.save(file);
  reserved.keep();
  bytes_ += size_of(file);
  return file.filename().string();
}

std::string ViewerFiles::start_recording(Tell tell) {
  if (recorder_) throw ActRefused("the run is being recorded already: stop this recording first");
  const fs::path file = new_file("recording");
  Reserved reserved(file);
  RecordingOptions options;
  options.replace = true;  // the empty file
  recorder_.emplace(file, simulation_, options);
  reserved.keep();
  recording_ = file;
  tell_ = std::move(tell);
  return file.filename().string();
}

void ViewerFiles::use_recording(const std::function<void(Recording&)>& use) {
  if (!recorder_) return;
  try {
    use(*recorder_);
  } catch (const std::exception& error) {
    end_recording();
    tell_(fmt::format("the recording ends, because it cannot be written: {}", error.what()));
  }
}

void ViewerFiles::observe() {
  use_recording([this](Recording& recording) { recording.observe(simulation_); });
}

void ViewerFiles::stop_recording() {
  if (!recorder_) return;
  std::exception_ptr failure;
  try {
    recorder_->close();
  } catch (const std::exception&) {
    failure = std::current_exception();
  }
  end_recording();
  if (failure) std::rethrow_exception(failure);
}

void ViewerFiles::end_with_the_run() {
  use_recording([](Recording& recording) { recording.close(); });
  if (recorder_) end_recording();
}

/// Forgets the recording, and counts the bytes of its file.
void ViewerFiles::end_recording() {
  recorder_.reset();
  bytes_ += size_of(recording_);
  recording_.clear();
}

void ViewerFiles::limit_recording() {
  if (!recorder_ || bytes_ + size_of(recording_) < k_most_file_bytes) return;
  const std::string file = recording_.string();
  use_recording([](Recording& recording) { recording.close(); });
  if (!recorder_) return;  // closing it has failed, and the viewer knows it
  end_recording();
  tell_(fmt::format("{}: the recording ends, because the files that viewers requested have reached {} GB",
                    file, k_most_file_bytes / k_bytes_gb));
}

}  // namespace troupe::live
