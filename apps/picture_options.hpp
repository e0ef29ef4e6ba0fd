#pragma once

#include "troupe/pictures.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// Which pictures a run leaves, and how they look.
struct PictureFiles {
  std::filesystem::path snapshot;    ///< empty: none
  std::vector<double> snapshot_at_s;  ///< empty: at the end
  std::filesystem::path film;        ///< a film, or frames with `%06d` for their number; empty: none
  double fps = 30;
  double film_speed = 1;  ///< simulated seconds a second of film
  PictureOptions look;
};

/// In the names of snapshots this stands for the simulated time.
inline constexpr std::string_view k_time_mark = "{time}";
/// The files of all snapshots, in the order of their times.
std::vector<std::filesystem::path> snapshot_files(const PictureFiles& pictures);
/// True for a film that is written as pictures, one a frame.
bool is_frames(const std::filesystem::path& film);
/// The file of one of them, counted from 0.
std::filesystem::path frame_file(const std::filesystem::path& film, std::size_t frame);

/// Adds --snapshot, --film and what says how they look; `pictures` must outlive `app`. What is wrong is a
/// CLI::ParseError.
void add_picture_options(CLI::App& app, PictureFiles& pictures);
/// What --layers takes, and what cameras there are, for a command's help.
std::string picture_help();

}  // namespace troupe::apps
