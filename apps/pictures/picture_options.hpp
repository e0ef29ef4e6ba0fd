#pragma once

#include "troupe/pictures.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// The pictures and the film that a run writes.
struct PictureFiles {
  std::filesystem::path snapshot;     ///< empty: none
  std::vector<double> snapshot_at_s;  ///< world times, s; empty: at the end
  std::filesystem::path film;         ///< film file, or picture files with `%06d`; empty: none
  double fps = 30;
  double film_speed = 1;  ///< simulated seconds per second of film
  PictureOptions look;
};

/// Placeholder for the simulated time in the names of snapshots.
inline constexpr std::string_view k_time_mark = "{time}";
/// The files of all snapshots, in the order of their times.
std::vector<std::filesystem::path> snapshot_files(const PictureFiles& pictures);
/// Whether a film is written as one picture per frame.
bool is_frames(const std::filesystem::path& film);
/// The file of a frame, counted from 0.
std::filesystem::path frame_file(const std::filesystem::path& film, std::size_t frame);

/// Adds --snapshot, --snapshot-at, --film and the options of add_look_options(); `pictures` must outlive
/// `app`. Parsing throws CLI::ParseError for invalid values.
void add_picture_options(CLI::App& app, PictureFiles& pictures);

// Parts for other commands that draw. `option` is the name of the option in that command.

/// Adds the options that set how pictures look: --size, --camera, --layers, ...
void add_look_options(CLI::App& app, PictureOptions& look);
/// Adds --film, --fps and --film-speed.
void add_film_options(CLI::App& app, PictureFiles& pictures);
void set_snapshot(PictureFiles& pictures, const char* option, const std::string& text);
void set_times(PictureFiles& pictures, const char* option, const std::string& text);
/// Throws CLI::ValidationError if several times are given without {time} in the name.
void check_names(const PictureFiles& pictures, const char* times_option, const char* name_option);

/// Returns the list of cameras and of layers (--camera, --layers), for the help of a command.
std::string picture_help();

}  // namespace troupe::apps
