#pragma once

#include "worldio/results/hdf5_file.hpp"

#include <cstdint>
#include <filesystem>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// A recording that write() creates without Troupe's recorder, as docs/recordings.md specifies the format. By
/// default the recording is valid. Tests change the members to make invalid recordings.
struct RecordingByHand {
  std::string kind = "troupe recording";
  std::int64_t layout = 1;
  std::int64_t every = 2;
  std::vector<std::uint32_t> ids = {1, 3, 4};
  std::vector<std::string> types = {"bot", "cart", "bot"};
  std::vector<std::string> names = {"a", "b", "c"};
  std::vector<std::uint64_t> ticks = {0, 2, 4};
  std::vector<double> times_s = {0.5, 0.5, 1};
  std::size_t x_frames = 3;
  std::vector<std::size_t> x_row = {3, 1};
  std::vector<std::size_t> alive;  // shape of /state/alive, which older recordings do not have; empty: none
  std::size_t sensor_rows = 2;
  bool with_frames = true;

  template <class T>
  static void array(Hdf5Group group, const std::string& name, std::size_t frames,
                    std::vector<std::size_t> row) {
    std::vector<std::size_t> chunk = {4};
    chunk.insert(chunk.end(), row.begin(), row.end());
    Hdf5Dataset dataset = group.create_extendible(name, engine::element_of<T>(), row, {.extent = chunk});
    dataset.set_text("unit", "m");
    dataset.set_text("frame", "world");
    dataset.set_text("text", "a number");
    std::vector<T> values(frames * dataset.row_values());
    std::iota(values.begin(), values.end(), T(0));
    dataset.append(std::span<const T>(values));
  }

  template <class T>
  static void column(Hdf5Group& group, const std::string& name, const std::vector<T>& values) {
    group.create_extendible(name, engine::element_of<T>(), {}, {.extent = {4}})
        .append(std::span<const T>(values));
  }

  void write(const std::filesystem::path& name) const {
    Hdf5File file = Hdf5File::create(name);
    Hdf5Group meta = file.create_group("meta");
    meta.set_text("kind", kind);
    meta.set_integer("layout", layout);
    meta.set_integer("record_every_ticks", every);
    meta.set_text("seed", "5");
    file.write_text("world", "{}");
    Hdf5Group bodies = file.create_group("bodies");
    bodies.write("id", std::span<const std::uint32_t>(ids));
    bodies.write_texts("type", types);
    bodies.write_texts("name", names);
    Hdf5Group state = file.create_group("state");
    array<double>(state.create_group("pose"), "x", x_frames, x_row);
    if (!alive.empty())
      array<std::uint8_t>(std::move(state), "alive", alive[0], {alive.begin() + 1, alive.end()});
    array<float>(file.create_group("sensors").create_group("bot").create_group("eye"), "ranges", 3,
                 {sensor_rows, 2});
    if (!with_frames) return;
    Hdf5Group frames = file.create_group("frames");
    column(frames, "tick", ticks);
    column(frames, "time_s", times_s);
    column(frames, "hash", std::vector<std::uint64_t>(ticks.size(), 9));
  }
};

}  // namespace troupe::worldio
