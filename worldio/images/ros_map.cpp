#include "worldio/images/ros_map.hpp"

#include "base/limits.hpp"
#include "base/number_text.hpp"
#include "worldio/files.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace troupe::worldio {
namespace {

constexpr std::size_t k_most_bytes = 1 << 16;          // size of a YAML file; a map has a dozen lines
constexpr double k_most_meters = 2 * k_world_reach_m;  // greatest size of a world

constexpr std::string_view k_keys[] = {"image",           "resolution",  "origin", "negate",
                                       "occupied_thresh", "free_thresh", "mode"};
constexpr std::array<std::string_view, 3> k_modes = {"trinary", "scale", "raw"};

/// Reads the whole text as a finite number, with or without a leading "+", which YAML allows. Returns nothing
/// for any other text.
std::optional<double> yaml_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return finite_number_of(text);
}

class MapReader {
 public:
  MapReader(const std::filesystem::path& file, Diagnostics& diagnostics)
      : file_(file), file_number_(diagnostics.files()->add(file.string())), diagnostics_(diagnostics) {}

  std::optional<RosMap> read(std::string_view text) {
    try {
      const std::vector<YAML::Node> documents = YAML::LoadAll(std::string(text));
      if (documents.size() > 1) {
        error(documents[1],
              "a ROS map is one YAML document, but here a second one begins: remove the line \"---\"");
        return {};
      }
      return read(documents.empty() ? YAML::Node() : documents.front());
    } catch (const YAML::Exception& exception) {
      error(line_of(exception.mark), fmt::format("not valid YAML: {}", exception.msg));
      return {};
    }
  }

 private:
  std::optional<RosMap> read(const YAML::Node& map);
  void check_keys(const YAML::Node& map);
  std::optional<double> number(const YAML::Node& value, std::string_view key, double min, double max,
                               std::string_view what);
  void read_origin(const YAML::Node& origin, RosMap& map);
  void read_thresholds(const YAML::Node& node, RosMap& map);

  static std::uint32_t line_of(const YAML::Mark& mark) {
    return mark.is_null() ? 0 : static_cast<std::uint32_t>(mark.line + 1);
  }
  void error(std::uint32_t line, std::string message) {
    diagnostics_.error({file_number_, line}, std::move(message));
    is_right_ = false;
  }
  void error(const YAML::Node& at, std::string message) { error(line_of(at.Mark()), std::move(message)); }
  /// Reports an error about the value of a key. The place of a missing value is the line after it, so that of
  /// the key is used instead.
  void error(const YAML::Node& value, std::string_view key, std::string message) {
    const auto line = key_lines_.find(key);
    error(value.IsNull() && line != key_lines_.end() ? line->second : line_of(value.Mark()),
          std::move(message));
  }
  static std::string shown(const YAML::Node& value) {
    return value.IsScalar()     ? fmt::format("\"{}\"", value.Scalar())
           : value.IsSequence() ? std::string("a list")
           : value.IsMap()      ? std::string("a map")
                                : std::string("nothing");
  }

  const std::filesystem::path& file_;
  std::uint32_t file_number_;
  Diagnostics& diagnostics_;
  bool is_right_ = true;
  std::map<std::string, std::uint32_t, std::less<>> key_lines_;  // key -> its first line
};

std::optional<RosMap> MapReader::read(const YAML::Node& node) {
  if (!node.IsMap()) {
    error(0, fmt::format(
                 "a ROS map consists of lines \"key: value\" with the keys image, resolution, origin and "
                 "others, found {}",
                 shown(node)));
    return {};
  }
  for (const auto& entry : node)
    if (entry.first.IsScalar()) key_lines_.emplace(entry.first.Scalar(), line_of(entry.first.Mark()));
  RosMap map;
  if (const YAML::Node image = node["image"]; !image) {
    error(0, "a ROS map needs the key \"image\", the path of its image");
  } else if (!image.IsScalar() || image.Scalar().empty()) {
    error(image, "image", fmt::format("\"image\" needs the path of an image, found {}", shown(image)));
  } else {
    map.image = file_.parent_path() / image.Scalar();
    map.where_image = {file_number_, line_of(image.Mark())};
  }
  if (const YAML::Node resolution = node["resolution"]; !resolution) {
    error(0, "a ROS map needs the key \"resolution\", the edge length of a cell in m");
  } else {
    map.resolution_m =
        number(resolution, "resolution", 1e-6, k_most_meters, "a length from 0.000001 to 200000 m")
            .value_or(1);
    map.where_resolution = {file_number_, line_of(resolution.Mark())};
  }
  if (const YAML::Node origin = node["origin"])
    read_origin(origin, map);
  else
    error(0, "a ROS map needs the key \"origin\", the pose of its lower left corner: [x, y, yaw]");
  read_thresholds(node, map);
  if (const YAML::Node negate = node["negate"]) {
    const std::string text = negate.IsScalar() ? negate.Scalar() : "";
    map.negate = text == "1" || text == "true";
    if (!map.negate && text != "0" && text != "false")
      error(negate, "negate", fmt::format("\"negate\" needs 0, 1, false or true, found {}", shown(negate)));
  }
  if (const YAML::Node mode = node["mode"]) {
    const std::string name = mode.IsScalar() ? mode.Scalar() : "";
    const auto known = std::ranges::find(k_modes, name);
    if (known != k_modes.end())
      map.mode = static_cast<RosMap::Mode>(known - k_modes.begin());
    else if (name.empty())
      error(mode, "mode",
            fmt::format("\"mode\" needs one of {}, found {}", comma_list(k_modes), shown(mode)));
    else
      error(mode, unknown_name("mode", name, {k_modes.begin(), k_modes.end()}));
  }
  check_keys(node);
  if (!is_right_) return {};
  return map;
}

/// Reports keys that are given twice as errors. Reports unknown keys as warnings or, in a map that has
/// errors, as errors. In such a map, warnings would not be shown, but the unknown key may be a misspelt form
/// of a missing key.
void MapReader::check_keys(const YAML::Node& map) {
  const bool is_right = is_right_;
  std::map<std::string, std::uint32_t> lines;
  for (const auto& entry : map) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    const auto [first, is_new] = lines.emplace(key, line_of(entry.first.Mark()));
    if (!is_new && !key.empty())
      error(entry.first,
            fmt::format("\"{}\" is given twice: line {} gives it already: remove one of the two lines", key,
                        first->second));
    if (std::ranges::find(k_keys, key) != std::end(k_keys)) continue;
    const std::string suggestion = did_you_mean(key, k_keys);
    if (is_right)
      diagnostics_.warning({file_number_, line_of(entry.first.Mark())},
                           fmt::format("a ROS map has no key \"{}\"; the key is ignored{}", key, suggestion));
    else
      error(entry.first, fmt::format("a ROS map has no key \"{}\"{}", key, suggestion));
  }
}

std::optional<double> MapReader::number(const YAML::Node& value, std::string_view key, double min, double max,
                                        std::string_view what) {
  const std::optional<double> given = value.IsScalar() ? yaml_number(value.Scalar()) : std::nullopt;
  if (given && *given >= min && *given <= max) return given;
  error(value, key, fmt::format("\"{}\" needs {}, found {}", key, what, shown(value)));
  return {};
}

void MapReader::read_origin(const YAML::Node& origin, RosMap& map) {
  if (!origin.IsSequence() || origin.size() != 3) {
    error(
        origin, "origin",
        fmt::format("\"origin\" needs a list of three numbers, [x, y, yaw], in m and rad, found {}",
                    origin.IsSequence() ? fmt::format("a list of length {}", origin.size()) : shown(origin)));
    return;
  }
  double parts[3] = {};
  for (std::size_t i = 0; i < 3; ++i)
    parts[i] = number(origin[i], "origin", -k_world_reach_m, k_world_reach_m,
                      fmt::format("[x, y, yaw]: x and y from -{0} to {0} m, yaw in rad", k_world_reach_m))
                   .value_or(0);
  map.pose_map_corner = {parts[0], parts[1], 0, wrap_angle(parts[2])};
}

void MapReader::read_thresholds(const YAML::Node& node, RosMap& map) {
  constexpr std::string_view k_probability = "a probability from 0 to 1";
  const auto read = [&](std::string_view key, double& threshold) {
    const YAML::Node given = node[std::string(key)];
    const std::optional<double> number_given =
        given ? number(given, key, 0, 1, k_probability) : std::optional(threshold);
    threshold = number_given.value_or(threshold);
    return number_given.has_value();
  };
  const bool has_occupied = read("occupied_thresh", map.occupied_thresh);
  const bool has_free = read("free_thresh", map.free_thresh);
  const YAML::Node free = node["free_thresh"];
  if (has_occupied && has_free && map.free_thresh > map.occupied_thresh)
    error(free ? free : node["occupied_thresh"],
          fmt::format("\"free_thresh\" is {}{}, but must be at most \"occupied_thresh\", which is {}",
                      map.free_thresh, free ? "" : " by default", map.occupied_thresh));
}

}  // namespace

bool is_ros_map(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".yaml" || ending == ".yml";
}

std::optional<RosMap> read_ros_map(const std::filesystem::path& file, Where where, Diagnostics& diagnostics) {
  const std::optional<std::string> text = read_file(file);
  if (text) return parse_ros_map(file, *text, diagnostics);
  const Result<> readable = check_readable(file, k_most_input_bytes);
  diagnostics.error(where, fmt::format("cannot read the map {}{}", file.string(),
                                       readable ? "" : ": " + readable.error().text));
  return {};
}

std::optional<RosMap> parse_ros_map(const std::filesystem::path& file, std::string_view text,
                                    Diagnostics& diagnostics) {
  if (text.size() > k_most_bytes) {
    diagnostics.error(
        {diagnostics.files()->add(file.string()), 0},
        fmt::format("the file is too large: {} bytes; a ROS map is a few lines of YAML, at most {} bytes",
                    text.size(), k_most_bytes));
    return {};
  }
  return MapReader(file, diagnostics).read(text);
}

PixelRule solid_cells(const RosMap& map, bool unknown_is_solid) {
  return [map, unknown_is_solid](std::span<const std::uint8_t> channels) {
    const bool has_opacity = channels.size() % 2 == 0;
    const std::size_t colors = channels.size() - (has_opacity ? 1 : 0);
    double sum = 0;
    for (std::size_t i = 0; i < colors; ++i) sum += channels[i];
    const double value = sum / static_cast<double>(colors);
    if (map.mode == RosMap::Mode::raw)
      return value > 100 ? unknown_is_solid : value > 100 * map.occupied_thresh;
    const double occupied = map.negate ? value / 255 : 1 - value / 255;
    if (map.mode == RosMap::Mode::scale && has_opacity && channels.back() < 255) return unknown_is_solid;
    if (occupied > map.occupied_thresh) return true;
    return map.mode == RosMap::Mode::trinary && occupied >= map.free_thresh && unknown_is_solid;
  };
}

}  // namespace troupe::worldio
