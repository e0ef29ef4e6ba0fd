#pragma once

#include "apps/cli_app.hpp"
#include "troupe/pictures.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// The pictures and the film that a run writes. A snapshot is a picture of one simulated time.
struct PictureFiles {
  std::filesystem::path snapshot;     ///< name of the snapshots, which may contain {time}; empty: none
  std::vector<double> snapshot_at_s;  ///< simulated times of the snapshots, s; empty: only the end of the run
  std::filesystem::path film;         ///< film file, or name with `%06d` for single pictures; empty: no film
  double fps = 30;                    ///< frames per second of the film
  double film_speed = 1;              ///< simulated seconds per second of the film
  PictureOptions look;                ///< how all pictures and frames are drawn
};

/// Placeholder in the name of snapshots. It is replaced by the simulated time of the picture in seconds, such
/// as `0.5`.
inline constexpr std::string_view k_time_mark = "{time}";
/// Returns the names of all snapshot files: one for each time in `snapshot_at_s`, in the same order, with the
/// time in place of k_time_mark. If `snapshot_at_s` is empty, returns only the name `snapshot`. If `snapshot`
/// is empty, returns no names.
std::vector<std::filesystem::path> snapshot_files(const PictureFiles& pictures);
/// The part of the name of a film in place of which each frame has its number.
inline constexpr std::string_view k_number_mark = "%06d";
/// Whether a film with this name is written as one PNG file per frame: the file name contains `%06d` and ends
/// in `.png`.
bool is_frames(const std::filesystem::path& film);
/// Returns the name of the picture file for one frame of a film. is_frames() must be true for `film`. For
/// example, `frames/%06d.png` becomes `frames/000012.png` for frame 12. frame: number of the frame, from 0.
std::filesystem::path frame_file(const std::filesystem::path& film, std::size_t frame);

/// Adds --snapshot, --snapshot-at, --film and the options of add_look_options(); `pictures` must outlive
/// `app`. Parsing throws CLI::ParseError for invalid values.
void add_picture_options(CLI::App& app, PictureFiles& pictures);

// Parts of add_picture_options(), for commands whose options for pictures have other names, such as --output.

/// Adds the options that set how pictures look, such as --size, --camera and --layers. Parsing fills `look`,
/// which must outlive `app`.
void add_look_options(CLI::App& app, PictureOptions& look);
/// Adds --film, --fps and --film-speed. Parsing fills `pictures`, which must outlive `app`.
void add_film_options(CLI::App& app, PictureFiles& pictures);
/// Convert the value of an option and store it in `pictures`. Throw CLI::ParseError for invalid values.
///
/// set_snapshot()  `text` is the file name of the snapshots
/// set_times()     `text` is a list of simulated times of snapshots, s, such as `0,10,60`. The stored times
///                 are sorted and have no duplicates
/// option          name of the option, for the error
void set_snapshot(PictureFiles& pictures, const char* option, const std::string& text);
void set_times(PictureFiles& pictures, const char* option, const std::string& text);
/// Checks that snapshots of different times get different names. Throws CLI::ValidationError if `pictures`
/// has two or more times, but the name of the snapshots does not contain {time} (k_time_mark), or if it has
/// no times, but the name contains {time}. times_option, name_option: names of the two options, for the
/// error.
void check_names(const PictureFiles& pictures, const char* times_option, const char* name_option);

/// Returns a text for the help of a command, which lists all cameras and layers. Cameras are views of the
/// world, which --camera selects. Layers are groups of drawn objects, such as trails, which --layers selects.
std::string picture_help();

}  // namespace troupe::apps
