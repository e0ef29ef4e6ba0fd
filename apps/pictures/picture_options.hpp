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
  std::filesystem::path snapshot;     ///< empty: none
  std::vector<double> snapshot_at_s;  ///< empty: at the end
  std::filesystem::path film;         ///< a film, or frames with `%06d` for their number; empty: none
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

/// Adds --snapshot, --film and add_look_options(); `pictures` must outlive `app`. What is wrong is a
/// CLI::ParseError.
void add_picture_options(CLI::App& app, PictureFiles& pictures);

// What other commands that draw share with it: an option each, by the name that they have there.

/// Adds what says how pictures look: --size, --camera, --layers, ...
void add_look_options(CLI::App& app, PictureOptions& look);
/// Adds --film, --fps and --film-speed.
void add_film_options(CLI::App& app, PictureFiles& pictures);
void set_snapshot(PictureFiles& pictures, const char* option, const std::string& text);
void set_times(PictureFiles& pictures, const char* option, const std::string& text);
/// Several times need {time} in the name.
void check_names(const PictureFiles& pictures, const char* times_option, const char* name_option);

/// What --layers takes, and what cameras there are, for a command's help.
std::string picture_help();

}  // namespace troupe::apps
