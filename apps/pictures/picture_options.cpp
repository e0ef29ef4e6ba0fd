#include "apps/pictures/picture_options.hpp"

#include "apps/options.hpp"
#include "base/number_text.hpp"
#include "base/split.hpp"
#include "engine/spec/ticks.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

namespace troupe::apps {
namespace {

// Largest width and height, pixels, of a picture that Mesa can draw.
constexpr int k_max_pixels = 16384;
constexpr double k_farthest_m = 1e6;   // largest coordinate and width that options accept
constexpr double k_least_fps = 0.001;  // ffmpeg accepts no frame rate below 1e-6
constexpr double k_most_fps = 1000;
constexpr double k_least_speed = 0.001;  // at lower speeds films become days long
constexpr double k_most_speed = 1e6;

void set_picture_size(PictureOptions& look, const std::string& text) {
  const auto cross = text.find('x');
  const auto width = number_of<int>(text.substr(0, cross));
  const auto height = cross == text.npos ? std::nullopt : number_of<int>(text.substr(cross + 1));
  const auto good = [](std::optional<int> n) { return n && *n >= 1 && *n <= k_max_pixels; };
  if (!good(width) || !good(height))
    refuse("--size", text,
           fmt::format("a width and a height in pixels, 1 to {} each, as in --size 1280x720", k_max_pixels));
  look.width = *width;
  look.height = *height;
}

/// Converts a text such as `2.5,-4` to two numbers. Returns std::nullopt if the text has another form. With
/// `one_is_enough`, the second number may be missing and is then 0.
std::optional<std::array<double, 2>> two_numbers(const std::string& text, bool one_is_enough) {
  const auto comma = text.find(',');
  const auto first = finite_number_of(text.substr(0, comma));
  std::optional<double> second;
  if (comma != text.npos)
    second = finite_number_of(text.substr(comma + 1));
  else if (one_is_enough)
    second = 0;
  if (!first || !second) return std::nullopt;
  return std::array{*first, *second};
}

void set_center(PictureOptions& look, const std::string& text) {
  const auto center = two_numbers(text, false);
  if (!center || std::max(std::abs((*center)[0]), std::abs((*center)[1])) > k_farthest_m)
    refuse("--center", text,
           fmt::format("x and y in metres, from -{0} to {0}, as in --center 2.5,-4", k_farthest_m));
  look.center_m = center;
}

void set_angle(PictureOptions& look, const std::string& text) {
  const auto angle = two_numbers(text, true);
  if (!angle || (*angle)[0] < 0 || (*angle)[0] > 90 || std::abs((*angle)[1]) > 360)
    refuse("--angle", text,
           "a pitch in degrees, 0 (straight down) to 90 (level), and a yaw, -360 to 360, as in --angle "
           "50,30");
  look.angle_rad = std::array{radians((*angle)[0]), radians((*angle)[1])};
}

void set_across(PictureOptions& look, const std::string& text) {
  const std::optional<double> across = finite_number_of(text);
  if (!across || *across < k_least_across_m || *across > k_farthest_m)
    refuse("--across", text,
           fmt::format("a length in metres, from {} to {}", k_least_across_m, k_farthest_m));
  look.across_m = across;
}

constexpr std::array k_looks = {"--size",   "--camera",   "--center",      "--angle",     "--across",
                                "--layers", "--color-by", "--color-range", "--background"};

void add_files(CLI::App& app, PictureFiles& pictures) {
  CLI::Option* const snapshot = add_value(
      app, "--snapshot", "FILE", "Draw the end of the run as a .png picture, or as a .svg or .pdf map",
      [&pictures](const std::string& text) { set_snapshot(pictures, "--snapshot", text); });
  add_value(
      app, "--snapshot-at", "T,...",
      "Draw these simulated times, s, instead of the end; {time} in FILE is replaced by the time",
      [&pictures](const std::string& text) { set_times(pictures, "--snapshot-at", text); }, snapshot);
  add_film_options(app, pictures);
}

/// Throws CLI::ParseError for combinations of options that are not allowed.
void check(const CLI::App& app, const PictureFiles& pictures) {
  for (const char* name : k_looks)
    if (app.count(name) > 0 && pictures.snapshot.empty() && pictures.film.empty())
      throw CLI::RequiresError(name, "--snapshot or --film");
  check_names(pictures, "--snapshot-at", "--snapshot");
}

}  // namespace

std::vector<std::filesystem::path> snapshot_files(const PictureFiles& pictures) {
  if (pictures.snapshot.empty()) return {};
  if (pictures.snapshot_at_s.empty()) return {pictures.snapshot};
  std::vector<std::filesystem::path> files;
  for (const double time : pictures.snapshot_at_s) {
    std::string name = pictures.snapshot.string();
    const std::string text = fmt::format("{:.10g}", time);
    for (std::size_t at = 0; (at = name.find(k_time_mark, at)) != name.npos; at += text.size())
      name.replace(at, k_time_mark.size(), text);
    files.emplace_back(name);
  }
  return files;
}

bool is_frames(const std::filesystem::path& film) {
  return film.extension() == ".png" && film.filename().string().find(k_number_mark) != std::string::npos;
}

std::filesystem::path frame_file(const std::filesystem::path& film, std::size_t frame) {
  std::string name = film.filename().string();
  const std::string_view mark = k_number_mark;
  name.replace(name.find(mark), mark.size(), fmt::format("{:06}", frame));
  return film.parent_path() / name;
}

void add_film_options(CLI::App& app, PictureFiles& pictures) {
  CLI::Option* const film =
      add_value(app, "--film", "FILE.mp4",
                "Write a film with ffmpeg; a name like frames/%06d.png writes numbered pictures instead",
                [&pictures](const std::string& text) {
                  pictures.film = text;
                  const bool is_film = pictures.film.extension() == ".mp4" || is_frames(text);
                  if (!is_film || text.starts_with('-'))
                    refuse("--film", text, "the name of a film, as in --film crowd.mp4 or frames/%06d.png");
                });
  add_value(
      app, "--fps", "N", "Frames per second of the film (default: 30)",
      [&pictures](const std::string& text) {
        const std::optional<double> fps = finite_number_of(text);
        if (!fps || *fps < k_least_fps || *fps > k_most_fps)
          refuse("--fps", text,
                 fmt::format("a number of frames per second, from {} to {}", k_least_fps, k_most_fps));
        pictures.fps = *fps;
      },
      film);
  add_value(
      app, "--film-speed", "R", "Simulated seconds per second of the film (default: 1)",
      [&pictures](const std::string& text) {
        const std::optional<double> speed = finite_number_of(text);
        if (!speed || *speed < k_least_speed || *speed > k_most_speed)
          refuse("--film-speed", text,
                 fmt::format("a multiple of real time, from {} to {}", k_least_speed, k_most_speed));
        pictures.film_speed = *speed;
      },
      film);
}

void add_look_options(CLI::App& app, PictureOptions& look) {
  add_value(app, "--size", "WxH", "Size of pictures in pixels (default: 1280x720)",
            [&look](const std::string& text) { set_picture_size(look, text); });
  add_value(app, "--camera", "C",
            "View: top (default), fit, perspective, follow:all, follow:NAME or window; see below",
            [&look](const std::string& text) {
              look.camera = text;
              if (const Result<> known = check_camera(text); !known)
                throw CLI::ValidationError("--camera", known.error().text);
            });
  add_value(app, "--center", "X,Y",
            "Point at the centre of the picture, m (default: the picture shows the whole world)",
            [&look](const std::string& text) { set_center(look, text); });
  add_value(app, "--angle", "PITCH[,YAW]",
            "View angles in degrees: pitch 0 (straight down) to 90 (level), yaw counter-clockwise",
            [&look](const std::string& text) { set_angle(look, text); });
  add_value(app, "--across", "M",
            "Width of the region that the picture shows, measured at the centre of the picture, m",
            [&look](const std::string& text) { set_across(look, text); });
  add_value(app, "--layers", "A,-B,...",
            "Layers to draw in addition to the default layers, and, with -, layers to omit; see below",
            [&look](const std::string& text) {
              look.layers = text;
              const Result<> known =
                  text.empty() ? Error{"the list is empty; name layers, as in --layers trails,-grid"}
                               : check_layers(text);
              if (!known) throw CLI::ValidationError("--layers", known.error().text);
            });
  add_value(app, "--background", "B",
            "Background: paper (off-white, default), white, dark or transparent (not in films)",
            [&look](const std::string& text) {
              look.background = text;
              if (const Result<> known = check_background(text); !known)
                throw CLI::ValidationError("--background", known.error().text);
            });
  CLI::Option* const color_by =
      add_value(app, "--color-by", "COMPONENT.FIELD", "Colour robots by a field of the state",
                [&look](const std::string& text) {
                  if (text.empty())
                    refuse("--color-by", text, "a field of the state, as in --color-by velocity.x");
                  look.color_by = text;
                });
  add_value(
      app, "--color-range", "LOW,HIGH",
      "Values at the ends of the colour scale (default: smallest and largest of each picture)",
      [&look](const std::string& text) {
        look.color_range = two_numbers(text, false);
        if (!look.color_range || (*look.color_range)[0] >= (*look.color_range)[1])
          refuse("--color-range", text, "two numbers, the lower first, as in --color-range 0,0.5");
      },
      color_by);
}

void set_snapshot(PictureFiles& pictures, const char* option, const std::string& text) {
  pictures.snapshot = text;
  const std::filesystem::path ending = pictures.snapshot.extension();
  if ((ending != ".png" && ending != ".svg" && ending != ".pdf") || text.starts_with('-'))
    refuse(option, text,
           fmt::format("the name of a picture, as in {} crowd.png, crowd.svg or crowd.pdf", option));
}

void set_times(PictureFiles& pictures, const char* option, const std::string& text) {
  std::vector<double>& times = pictures.snapshot_at_s;
  for (const std::string_view item : split(text, ',')) {
    const std::optional<double> time = finite_number_of(item);
    if (!time || *time < 0 || *time > engine::k_most_seconds)
      refuse(option, text,
             fmt::format("a list of simulated times in seconds, each from 0 to {}, as in {} 0,60,600",
                         engine::k_most_seconds, option));
    times.push_back(*time);
  }
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
}

void check_names(const PictureFiles& pictures, const char* times_option, const char* name_option) {
  const std::string name = pictures.snapshot.string();
  const bool has_mark = name.find(k_time_mark) != name.npos;
  if (has_mark && pictures.snapshot_at_s.empty())
    throw CLI::ValidationError(
        name_option, fmt::format("{} in the name of a picture is the time that {} gives: give {}, or "
                                 "another name",
                                 k_time_mark, times_option, times_option));
  if (pictures.snapshot_at_s.size() < 2 || has_mark) return;
  throw CLI::ValidationError(
      times_option,
      fmt::format("several pictures need different names: write {} in the name, as in {} {}-{}.png",
                  k_time_mark, name_option, pictures.snapshot.stem().string(), k_time_mark));
}

void add_picture_options(CLI::App& app, PictureFiles& pictures) {
  add_files(app, pictures);
  add_look_options(app, pictures.look);
  app.final_callback([&app, &pictures] { check(app, pictures); });
}

std::string picture_help() {
  std::string text =
      "Cameras (--camera): top draws a map of the whole world, and fit a map of the region that contains the "
      "robots.\n"
      "perspective, follow:all (the region with robots) and follow:NAME (one robot in the centre) draw "
      "bodies as solids "
      "from\n"
      "an oblique angle. window draws the view of the window in the world file. --center, --angle and "
      "--across change the\n"
      "view of any camera. A .svg or .pdf contains vector graphics, and can show maps only.\n"
      "Layers (those in brackets are drawn only if --layers names them; -NAME omits a layer):\n";
  for (const PictureLayer& layer : picture_layers())
    text += fmt::format("  {:<13} {}\n", layer.on ? std::string(layer.name) : fmt::format("[{}]", layer.name),
                        layer.text);
  return text;
}

}  // namespace troupe::apps
