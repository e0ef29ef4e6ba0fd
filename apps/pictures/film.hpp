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

/// Writes a film: passes pictures to ffmpeg, a child process, which encodes them. ffmpeg writes a temporary
/// file in the folder of the film. finish() gives this file the name of the film, and replaces an older film.
/// If the film is not finished, the destructor removes the temporary file.
///
/// A program that is killed may leave the temporary file. The next film of the same name overwrites it,
/// except on file systems without locks.
class Ffmpeg {
 public:
  /// Starts ffmpeg. film: file to write; width, height: size of the pictures, pixels; fps: pictures per
  /// second of film. Throws OutputError if ffmpeg is not found (the text names the package to install), or if
  /// the file cannot be written.
  Ffmpeg(std::filesystem::path film, int width, int height, double fps);
  ~Ffmpeg();
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  /// Adds one picture: 8-bit RGBA, four bytes per pixel, row by row from the top, of the size given to the
  /// constructor. Throws std::runtime_error if ffmpeg has ended.
  void write(std::span<const std::uint8_t> rgba);
  /// Ends the film and waits until it is complete. Call it once, after the last write(). Throws
  /// std::runtime_error if ffmpeg fails.
  void finish();

 private:
  /// Throws std::runtime_error after ffmpeg has ended with this exit code.
  [[noreturn]] void fail(int exit_code) const;
  void start(const std::string& program, const std::vector<std::string>& arguments);
  /// Waits for the process and returns its exit code, or 128 plus the number of the signal that ended it.
  int wait();

  std::filesystem::path film_;
  std::optional<worldio::PartialFile> partial_;
  int pipe_ = -1;
  int process_ = -1;
};

/// Searches for the program ffmpeg in the folders of the environment variable PATH. Returns the path of the
/// program, or an empty text if it is not found.
std::string find_ffmpeg();
/// Checks that the film that `pictures` requests can be made. Throws OutputError if ffmpeg is missing or the
/// background is transparent. Does nothing if no film is requested, or if the film is written as one picture
/// file per frame. Writes no file.
void check_film(const PictureFiles& pictures);

}  // namespace troupe::apps
