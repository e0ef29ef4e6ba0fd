#pragma once

#include "apps/pictures/picture_options.hpp"
#include "worldio/partial_file.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::apps {

/// A film that a child process (ffmpeg) encodes from pictures. The film is written to a temporary file in the
/// same folder, which is renamed when the film is complete. The temporary file of an unfinished film is
/// removed, unless the program is killed by SIGKILL; the next film with the same name then replaces it.
class Ffmpeg {
 public:
  /// Throws OutputError if ffmpeg is not found; the message names the package to install.
  Ffmpeg(std::filesystem::path film, int width, int height, double fps);
  ~Ffmpeg();
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  /// Adds one picture, 8-bit RGBA. Throws std::runtime_error if ffmpeg has ended.
  void write(std::span<const std::uint8_t> rgba);
  /// Waits until the film is complete. Throws std::runtime_error if ffmpeg fails.
  void finish();

 private:
  [[noreturn]] void fail();
  void start(const std::string& program, const std::vector<std::string>& arguments);
  /// Waits for the process and returns its exit code, or 128 plus the number of the signal that ended it.
  int wait();

  std::filesystem::path film_;
  std::optional<worldio::PartialFile> partial_;
  int pipe_ = -1;
  int process_ = -1;
};

/// The path of ffmpeg, searched in PATH; empty: not found.
std::string find_ffmpeg();
/// Throws OutputError if the film cannot be made. Writes nothing.
void check_film(const PictureFiles& pictures);

}  // namespace troupe::apps
