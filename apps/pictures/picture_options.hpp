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
  std::filesystem::path snapshot;     ///< name of the picture file, which may contain {time}; empty: none
  std::vector<double> snapshot_at_s;  ///< simulated times of the pictures, s; empty: only the end of the run
  std::filesystem::path film;         ///< film file, or picture files with `%06d`; empty: none
  double fps = 30;                    ///< frames per second of the film
  double film_speed = 1;              ///< simulated seconds per second of the film
  PictureOptions look;                ///< how all pictures and frames are drawn
};

/// Placeholder in the names of snapshots, which is replaced by the simulated time, s, such as `0.5`.
inline constexpr std::string_view k_time_mark = "{time}";
/// Returns the files of all snapshots, in the order of `snapshot_at_s` and with their times in place of
/// k_time_mark; if `snapshot_at_s` is empty, only the file `snapshot`; empty if there is no snapshot.
std::vector<std::filesystem::path> snapshot_files(const PictureFiles& pictures);
/// Whether a film with this name is written as one PNG file per frame: the file name contains `%06d` and ends
/// in `.png`.
bool is_frames(const std::filesystem::path& film);
/// Returns the file of a frame of a film for which is_frames() is true: the number of the frame, from 0, with
/// six digits replaces `%06d`.
std::filesystem::path frame_file(const std::filesystem::path& film, std::size_t frame);

/// Adds --snapshot, --snapshot-at, --film and the options of add_look_options(); `pictures` must outlive
/// `app`. Parsing throws CLI::ParseError for invalid values.
void add_picture_options(CLI::App& app, PictureFiles& pictures);

// Parts of add_picture_options(), for commands whose options for pictures have other names, such as --output.

/// Adds the options that set how pictures look: --size, --camera, --layers, ... Parsing fills `look`, which
/// must outlive `app`.
void add_look_options(CLI::App& app, PictureOptions& look);
/// Adds --film, --fps and --film-speed. Parsing fills `pictures`, which must outlive `app`.
void add_film_options(CLI::App& app, PictureFiles& pictures);
/// Stores `text`, the value of the option `option`, in `pictures`: set_snapshot() as the file name of the
/// snapshots, set_times() as their times, s, sorted and without duplicates. Throws CLI::ParseError for
/// invalid values.
void set_snapshot(PictureFiles& pictures, const char* option, const std::string& text);
void set_times(PictureFiles& pictures, const char* option, const std::string& text);
/// Throws CLI::ValidationError if several times are given and the name of the snapshots has no {time}
/// (k_time_mark). times_option, name_option: names of the two options, for the error.
void check_names(const PictureFiles& pictures, const char* times_option, const char* name_option);

/// Returns the list of cameras (views of the world, --camera) and of layers (what is drawn, such as trails;
/// --layers), for the help of a command.
std::string picture_help();

}  // namespace troupe::apps
