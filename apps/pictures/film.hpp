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

/// A film that ffmpeg, a process of its own, makes of pictures. It is written beside its name and renamed
/// when it is whole; a film that is not finished leaves nothing, unless the program is killed by SIGKILL: the
/// next film of the name then takes the place of what it left.
class Ffmpeg {
 public:
  /// Throws OutputError where there is no ffmpeg, with the package to install.
  Ffmpeg(std::filesystem::path film, int width, int height, double fps);
  ~Ffmpeg();
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  /// One picture, 8-bit RGBA. Throws std::runtime_error where ffmpeg has ended.
  void write(std::span<const std::uint8_t> rgba);
  /// Waits until the film is whole. Throws std::runtime_error where ffmpeg says that it is not.
  void finish();

 private:
  [[noreturn]] void fail();
  void start(const std::string& program, const std::vector<std::string>& arguments);
  /// Its exit code, once it has ended; 128 and more: by a signal.
  int wait();

  std::filesystem::path film_;
  std::optional<worldio::PartialFile> partial_;
  int pipe_ = -1;
  int process_ = -1;
};

/// Where ffmpeg is, by PATH; empty: nowhere.
std::string find_ffmpeg();
/// Throws OutputError where the film that is wanted cannot be made, before anything is written.
void check_film(const PictureFiles& pictures);

}  // namespace troupe::apps
