#include "worldio/wrong_file.hpp"

#include "worldio/characters.hpp"
#include "worldio/results/hdf5_superblock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace troupe::worldio {
namespace {

constexpr std::string_view k_white_space_of_files = " \t\r\n\v\f";
constexpr std::string_view k_no_command = "no command of Troupe reads it";
constexpr std::string_view k_as_bitmap = "a model of a world can name it as its \"bitmap\"";

/// A type of file, and what a user can do with such a file.
struct FileType {
  std::string_view mark;  ///< text with which the file begins, or the name of the root element
  std::string_view what;
  std::string_view use;
};

constexpr FileType k_types[] = {
    {k_hdf5_signature, "an HDF5 file",
     "if it is a recording, troupe replay plays it; troupe info describes it"},
    {"troupe checkpoint", "a checkpoint", "troupe resume continues its run"},
    {"# troupe hash log", "a hash log", "troupe diff compares two of them"},
    {"{\"troupe_sweep\"", "a journal of troupe sweep", "troupe info describes it"},
    {"{\"troupe_session\"", "a session of troupe view", "troupe run WORLD --session FILE repeats it"},
    {"\x89PNG", "a PNG picture", k_as_bitmap},
    {"\xff\xd8\xff", "a JPEG picture", k_as_bitmap},
    {"GIF8", "a GIF picture", "convert it to PNG; then a model of a world can name it as its \"bitmap\""},
    {"II*", "a TIFF picture", "convert it to PNG; then a model of a world can name it as its \"bitmap\""},
    {"MM\0*", "a TIFF picture", "convert it to PNG; then a model of a world can name it as its \"bitmap\""},
    {"\x7f"
     "ELF",
     "a program or a shared library", "if it is a plug-in, --plugin-path names its folder"},
    {"PK\x03\x04", "a ZIP archive", "unpack it first"},
    {"\x1f\x8b", "compressed (gzip)", "unpack it first"},
    {"%PDF", "a PDF document", k_no_command},
    {"#VRML_SIM", "a world of Webots (.wbt)", k_no_command},
    {"#VRML", "a VRML model", k_no_command},
    {"version https://git-lfs", "a pointer of Git LFS", "git lfs pull fetches the file itself"},
};

constexpr FileType k_elements[] = {
    {"sdf", "a world or model of Gazebo (SDF)", k_no_command},
    {"gazebo", "a world or model of Gazebo (SDF)", k_no_command},
    {"robot", "a robot description (URDF)", k_no_command},
    {"argos-configuration", "an experiment of ARGoS (.argos)",
     "docs/from-argos.md shows how to write it as a world"},
    {"launch", "a launch file of ROS", "give the world file that it names"},
    {"mujoco", "a model of MuJoCo", k_no_command},
    {"svg", "an SVG drawing", "convert it to PNG; then a model of a world can name it as its \"bitmap\""},
    {"html", "a web page", "download the file itself, not the page that shows it"},
};

void skip(std::string_view& text, std::string_view characters) {
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(characters)));
}

void skip_to_after(std::string_view& text, std::string_view end) {
  const std::size_t at = text.find(end);
  text.remove_prefix(at == text.npos ? text.size() : at + end.size());
}

/// Returns the name of the root element of an XML or HTML document in lower case; empty if the text is none.
std::string root_element(std::string_view text) {
  bool is_xml = false;
  for (skip(text, k_white_space_of_files); text.starts_with('<'); skip(text, k_white_space_of_files)) {
    if (text.starts_with("<!--")) {
      skip_to_after(text, "-->");
    } else if (text.starts_with("<?") || text.starts_with("<!")) {
      skip_to_after(text, ">");
    } else {
      const std::string_view name = text.substr(1, text.find_first_of(" \t\r\n/>", 1) - 1);
      std::string lower(name.substr(0, 40));
      std::ranges::transform(lower, lower.begin(), [](char c) {
        return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      });
      return lower;
    }
    is_xml = true;
  }
  return is_xml ? "?" : "";
}

/// Removes comments that begin with # and empty lines from the start of a text.
void skip_comments(std::string_view& text) {
  for (skip(text, k_white_space_of_files); text.starts_with('#'); skip(text, k_white_space_of_files))
    text.remove_prefix(std::min(text.size(), text.find_first_of("\r\n")));
}

/// Whether a line of the text begins with `key`, which a colon follows.
bool has_key(std::string_view text, std::string_view key) {
  for (std::size_t at = 0; (at = text.find(key, at)) != text.npos; ++at) {
    std::string_view rest = text.substr(at + key.size());
    skip(rest, " \t");
    if ((at == 0 || text[at - 1] == '\n') && rest.starts_with(':')) return true;
  }
  return false;
}

std::string wrong_line(std::string_view what, std::string_view use) {
  return fmt::format("this is {}, not a world of Stage or Troupe: {}", what, use);
}

/// Returns the text of an error about a text file; empty if it may be a world.
std::optional<std::string> wrong_text(std::string_view text) {
  if (const std::string root = root_element(text); !root.empty()) {
    const auto* known = std::ranges::find(k_elements, root, &FileType::mark);
    if (known != std::end(k_elements)) return wrong_line(known->what, known->use);
    return wrong_line(
        root == "?" ? "an XML file" : fmt::format("an XML file with the root element <{}>", root),
        k_no_command);
  }
  if (has_key(text, "image") && has_key(text, "resolution"))
    return wrong_line("the YAML file of a ROS map", k_as_bitmap);
  skip_comments(text);
  const std::size_t end = std::min(text.size(), text.find_first_of(" \t\r\n("));
  const std::string_view word = text.substr(0, end);
  std::string_view rest = text.substr(end);
  skip(rest, k_white_space_of_files);
  const std::string_view first_line = rest.substr(0, rest.find('\n'));
  const bool begins = word == "begin" && !rest.starts_with('(') && text.find("\nend") != text.npos;
  const bool sets = word == "set" && first_line.find(" = ") != first_line.npos;
  if (begins || sets)
    return wrong_line("in the syntax of the first versions of Stage",
                      "write each model in parentheses, as in position( pose [0 0 0 0] )");
  if (word == "driver" && rest.starts_with('(')) {
    std::string_view world = text;
    skip_to_after(world, "worldfile");
    skip_to_after(world, "\"");
    world = world.substr(0, world.find('"'));
    return wrong_line("a configuration of the Player server",
                      world.empty() || world.size() > 200
                          ? "give the world file that it names"
                          : fmt::format("give the world file that it names, \"{}\"", world));
  }
  const bool is_key = word.size() > 1 && word.ends_with(':') && word.find_first_of("\"'<{") == word.npos;
  if (word == "---" || word == "%YAML" || is_key) return wrong_line("a YAML file", k_no_command);
  return std::nullopt;
}

/// Whether the bytes are not text: more than one in twenty is a control character that texts do not have. In
/// UTF-16, texts have NUL bytes.
bool is_binary(std::string_view start, bool is_utf16) {
  const auto is_control = [is_utf16](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 7 && !(is_utf16 && byte == 0)) || (byte > 13 && byte < 32 && byte != 27) || byte == 127;
  };
  const auto controls = static_cast<std::size_t>(std::ranges::count_if(start, is_control));
  return controls >= 4 && 20 * controls > start.size();
}

}  // namespace

std::optional<std::string> wrong_file_text(std::string_view start) {
  start = start.substr(0, k_wrong_file_bytes);
  const bool is_wide = is_utf16(start);
  if (is_wide && !is_binary(start, true)) return std::nullopt;  // the readers of worlds say so
  if (start.starts_with("\xef\xbb\xbf")) start.remove_prefix(3);
  if (start.find_first_not_of(k_white_space_of_files) == start.npos)
    return "the file is empty: a world has at least one model";
  for (const FileType& type : k_types)
    if (start.starts_with(type.mark)) return wrong_line(type.what, type.use);
  const bool is_pnm = start.size() > 2 && start[0] == 'P' && start[1] >= '1' && start[1] <= '6' &&
                      k_white_space_of_files.find(start[2]) != k_white_space_of_files.npos;
  if (is_pnm) return wrong_line("a PBM, PGM or PPM picture", k_as_bitmap);
  if (start.starts_with("BM") && start.size() > 6 && is_binary(start, is_wide))
    return wrong_line("a BMP picture", k_as_bitmap);
  if (is_binary(start, is_wide)) return wrong_line("a binary file", k_no_command);
  return wrong_text(start);
}

}  // namespace troupe::worldio
