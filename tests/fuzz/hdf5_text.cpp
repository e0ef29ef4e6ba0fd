#include "tests/fuzz/hdf5_text.hpp"

#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/sealed_file.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace troupe::fuzz {
namespace {

using engine::Element;
using worldio::Hdf5Dataset;
using worldio::Hdf5File;
using worldio::Hdf5Group;

constexpr std::size_t k_most_values = 4096;  // numbers of a dataset that are written

template <class T>
T number(const std::string& text) {
  T value{};
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// Splits a path, such as /state/pose/x. Returns the group of its parent, /state/pose, which is created if it
/// does not exist, and its last name, x. For a path of one name, such as /x, the group is /nowhere.
std::pair<Hdf5Group, std::string> place(Hdf5File& file, const std::string& path) {
  std::istringstream steps(path);
  std::vector<std::string> names;
  for (std::string step; std::getline(steps, step, '/');)
    if (!step.empty()) names.push_back(step);
  if (names.empty()) throw worldio::Hdf5Error("no path");
  const std::string last = names.back();
  names.pop_back();
  if (names.empty()) return {file.create_group("nowhere"), last};  // the root group cannot be returned
  Hdf5Group group = file.has_group(names[0]) ? file.group(names[0]) : file.create_group(names[0]);
  for (std::size_t i = 1; i < names.size(); ++i)
    group = group.has_group(names[i]) ? group.group(names[i]) : group.create_group(names[i]);
  return {std::move(group), last};
}

/// Calls set(group) for the group with this path, which is created if it does not exist.
template <class Set>
void with_object(Hdf5File& file, const std::string& path, Set set) {
  auto [group, name] = place(file, path + "/.");
  set(group);
}

/// Gives a dataset this number of rows. Writes the numbers in `texts`, repeated, into the first rows; the
/// other rows keep the fill value.
template <class T>
void append_rows(Hdf5Dataset& dataset, std::size_t rows, const std::vector<std::string>& texts) {
  const std::size_t written = std::min(rows, k_most_values / std::max<std::size_t>(dataset.row_values(), 1));
  std::vector<T> values(written * dataset.row_values());
  for (std::size_t i = 0; i < values.size() && !texts.empty(); ++i)
    values[i] = number<T>(texts[i % texts.size()]);
  dataset.append(std::span<const T>(values));
  if (dataset.rows() < rows) dataset.resize(rows);
}

/// Makes a dataset of a fixed size, with the numbers in `texts`, repeated, as its values.
template <class T>
Hdf5Dataset make_fixed(Hdf5Group& group, const std::string& name, const std::vector<std::size_t>& extent,
                       const std::vector<std::string>& texts) {
  Hdf5Dataset dataset = group.create_dataset(name, engine::element_of<T>(), extent);
  std::size_t count = 1;
  for (const std::size_t size : extent) count = size == 0 ? 0 : count > k_most_values ? count : count * size;
  if (count > k_most_values) return dataset;
  std::vector<T> values(count);
  for (std::size_t i = 0; i < values.size() && !texts.empty(); ++i)
    values[i] = number<T>(texts[i % texts.size()]);
  dataset.write(std::span<const T>(values));
  return dataset;
}

/// Makes a dataset from the rest of its line. Returns false if `word`, the first word of the line, is not an
/// element type such as f64, or if the number of dimensions is not 1 to 5.
bool make_dataset(Hdf5File& file, const std::string& word, const std::string& path, std::istringstream& rest,
                  Hdf5Format format) {
  std::vector<std::size_t> extent;
  std::string next;
  while (rest >> next && next != "=") extent.push_back(number<std::size_t>(next));
  std::vector<std::string> texts;
  while (rest >> next) texts.push_back(next);
  if (extent.empty() || extent.size() > 5) return false;

  const auto make = [&]<class T>(T) {
    auto [group, name] = place(file, path);
    const std::vector<std::size_t> row(extent.begin() + 1, extent.end());
    std::vector<std::size_t> chunk{4};
    for (const std::size_t size : row) chunk.push_back(std::clamp<std::size_t>(size, 1, 64));
    Hdf5Dataset dataset;
    if (format == Hdf5Format::checkpoint) {
      dataset = make_fixed<T>(group, name, extent, texts);
    } else {
      dataset = group.create_extendible(name, engine::element_of<T>(), row, {.extent = chunk, .fill = {}});
      append_rows<T>(dataset, extent[0], texts);
    }
    for (const char* attribute : {"unit", "frame", "text"}) dataset.set_text(attribute, "m");
    return true;
  };
  if (word == "f64") return make(double{});
  if (word == "f32") return make(float{});
  if (word == "i64") return make(std::int64_t{});
  if (word == "i32") return make(std::int32_t{});
  if (word == "u64") return make(std::uint64_t{});
  if (word == "u32") return make(std::uint32_t{});
  return word == "u8" && make(std::uint8_t{});
}

bool make_line(Hdf5File& file, const std::string& line, Hdf5Format format) {
  std::istringstream words(line);
  std::string word;
  std::string path;
  if (!(words >> word >> path)) return line.empty();
  std::string name;
  std::string rest;
  if (word == "text" || word == "int" || word == "number") {
    words >> name >> std::ws;
    std::getline(words, rest);
    with_object(file, path, [&](Hdf5Group& group) {
      if (word == "text") group.set_text(name, rest);
      if (word == "int") group.set_integer(name, number<std::int64_t>(rest));
      if (word == "number") group.set_number(name, number<double>(rest));
    });
    return true;
  }
  if (word == "json") {
    std::getline(words >> std::ws, rest);
    if (path == "/world")
      file.write_text("world", rest);
    else
      place(file, path).first.write_text("text", rest);
    return true;
  }
  if (word == "texts") {
    std::vector<std::string> texts;
    while (words >> rest) texts.push_back(rest);
    auto [group, last] = place(file, path);
    group.write_texts(last, texts);
    return true;
  }
  return make_dataset(file, word, path, words, format);
}

}  // namespace

bool make_hdf5(std::string_view text, const std::filesystem::path& name, Hdf5Format format) {
  try {
    const bool in_memory = format == Hdf5Format::checkpoint;
    Hdf5File file =
        in_memory ? Hdf5File::create_in_memory(name, worldio::k_seal_bytes) : Hdf5File::create(name);
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);)
      if (!make_line(file, line, format)) return false;
    if (in_memory) {
      const std::vector<std::byte> bytes = file.image();
      std::ofstream(name, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    file.close();
    return true;
  } catch (const worldio::Hdf5Error&) {
    return false;
  }
}

}  // namespace troupe::fuzz
