#include "apps/diff/diff_recordings.hpp"

#include "apps/messages.hpp"
#include "apps/numbers.hpp"
#include "apps/run_header.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "engine/observing/state_difference.hpp"
#include "worldio/files.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/recording_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {
namespace {

using worldio::RecordingReader;

/// An array that both recordings contain, and buffers for one frame of the first (a) and the second recording
/// (b).
struct Pair {
  const RecordingReader::Array* first;
  const RecordingReader::Array* second;
  std::vector<std::byte> a, b;
};

RunHeader header_of(const RecordingReader& recording) {
  RunHeader header{.file = recording.file()};
  for (const auto& [key, value] : recording.meta()) header.entries[key] = {value};
  return header;
}

bool same_array(const RecordingReader::Array& a, const RecordingReader::Array& b) {
  return a.component == b.component && a.field.name == b.field.name && a.field.element == b.field.element &&
         a.field.columns == b.field.columns && a.bodies == b.bodies;
}

std::vector<Pair> common_arrays(const RecordingReader& first, const RecordingReader& second) {
  std::vector<Pair> pairs;
  for (const RecordingReader::Array& a : first.arrays())
    for (const RecordingReader::Array& b : second.arrays())
      if (same_array(a, b)) {
        const std::size_t bytes = a.bodies.size() * a.row_bytes();
        pairs.push_back({&a, &b, std::vector<std::byte>(bytes), std::vector<std::byte>(bytes)});
      }
  return pairs;
}

/// Returns the names of the components of the compared arrays, each name once: `pose, sensors/minibot/eye`.
std::string components_of(const std::vector<Pair>& pairs) {
  std::vector<std::string_view> names;
  for (const Pair& pair : pairs)
    if (names.empty() || names.back() != pair.first->component) names.push_back(pair.first->component);
  return names.empty() ? "nothing but hashes" : comma_list(names);
}

/// The differences of one component in one frame. `field`, `first` and `second` are the first field that
/// differs in the body `body`, with its values in the two recordings.
struct Difference {
  std::string component;
  std::size_t body = 0;  ///< lowest index, in the list of recorded bodies, of a body that differs
  std::string field;
  engine::StateValue first, second;
  std::vector<std::size_t> bodies;  ///< index of the body of each differing value
};

void compare(const Pair& pair, std::vector<Difference>& found) {
  if (pair.a == pair.b) return;
  engine::StateField field = pair.first->field;
  field.offset = 0;
  const std::size_t width = pair.first->row_bytes();
  for (std::size_t row = 0; row < pair.first->bodies.size(); ++row) {
    const std::size_t body = pair.first->bodies[row];
    engine::compare_rows({&field, 1}, pair.a.data() + row * width, pair.b.data() + row * width,
                         [&](const engine::StateField&, std::size_t column, const engine::StateValue& x,
                             const engine::StateValue& y) {
                           if (found.empty() || found.back().component != pair.first->component)
                             found.push_back({.component = pair.first->component, .body = body + 1});
                           Difference& difference = found.back();
                           if (body < difference.body) {
                             difference.body = body;
                             difference.field = engine::field_text(field, column);
                             difference.first = x;
                             difference.second = y;
                           }
                           difference.bodies.push_back(body);
                         });
  }
}

/// Returns the number of different values in a list.
std::size_t distinct(std::vector<std::size_t> values) {
  std::ranges::sort(values);
  return static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
}

void print_differences(const RecordingReader& first, std::size_t i, const RecordingReader& second,
                       std::size_t j, const std::vector<Difference>& differences) {
  fmt::print("differs at tick {} ({:.10g} s):\n", first.ticks()[i], first.times_s()[i]);
  for (const Difference& difference : differences) {
    const std::size_t bodies = distinct(difference.bodies);
    print("{}: {} of \"{}\" (id {}) is {} in {}, but {} in {}; {}\n", difference.component, difference.field,
          first.names()[difference.body], first.ids()[difference.body], engine::value_text(difference.second),
          second.file().string(), engine::value_text(difference.first), first.file().string(),
          bodies == 1 ? "1 body differs" : fmt::format("{} bodies differ", bodies));
  }
  if (differences.empty())
    fmt::print(
        "the state hash is {} in {}, but {} in {}: the state differs in a field that is not recorded in both "
        "files\n",
        hex(second.hashes()[j]), second.file().string(), hex(first.hashes()[i]), first.file().string());
}

/// Returns the recording that ends earlier than the other recording by at least one of its recording
/// intervals; null if there is none.
const RecordingReader* shorter(const RecordingReader& first, const RecordingReader& second) {
  const auto ends_before = [](const RecordingReader& a, const RecordingReader& b) {
    return a.ticks().back() + a.every_ticks() <= b.ticks().back();
  };
  if (ends_before(first, second)) return &first;
  return ends_before(second, first) ? &second : nullptr;
}

ExitCode compare_frames(const RecordingReader& first, const RecordingReader& second) {
  std::vector<Pair> pairs = common_arrays(first, second);
  std::size_t frames = 0;
  std::size_t last = 0;
  std::uint64_t begin = 0;
  for (std::size_t i = 0, j = 0; i < first.frames() && j < second.frames();) {
    if (first.ticks()[i] != second.ticks()[j]) {
      ++(first.ticks()[i] < second.ticks()[j] ? i : j);
      continue;
    }
    if (frames++ == 0) begin = first.ticks()[i];
    last = i;
    std::vector<Difference> differences;
    for (Pair& pair : pairs) {
      first.read(*pair.first, i, pair.a);
      second.read(*pair.second, j, pair.b);
      compare(pair, differences);
    }
    if (!differences.empty() || first.hashes()[i] != second.hashes()[j]) {
      print_differences(first, i, second, j, differences);
      return k_failed;
    }
    ++i;
    ++j;
  }
  if (frames == 0)
    throw InputError(
        fmt::format("{}: error: the recording has no tick in common with {}: record both runs with the same "
                    "--record-every, over the same time",
                    second.file().string(), first.file().string()));
  if (const RecordingReader* ended = shorter(first, second)) {
    fmt::print("differs in length: {} ends at tick {}, but {} continues; same bits from tick {} until then\n",
               ended->file().string(), ended->ticks().back(),
               (ended == &first ? second : first).file().string(), begin);
    return k_failed;
  }
  fmt::print("same bits, tick {} to {}, in {} of {}; the last state has the hash {}\n", begin,
             first.ticks()[last], counted(frames, "frame"), components_of(pairs), hex(first.hashes()[last]));
  return k_finished;
}

}  // namespace

bool is_hdf5(const std::filesystem::path& file) {
  if (!worldio::check_readable(file)) return false;
  std::string head(worldio::k_hdf5_signature.size(), '\0');
  std::ifstream(file, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  return head == worldio::k_hdf5_signature;
}

ExitCode diff_recordings(const DiffOptions& options) {
  for (const auto& [one, other] :
       {std::pair(options.first, options.second), std::pair(options.second, options.first)})
    if (!is_hdf5(one) && worldio::check_readable(one))
      throw InputError(
          fmt::format("{}: error: not a recording (troupe run --record), but {} is one: give two recordings "
                      "or two hash logs",
                      one.string(), other.string()));
  try {
    const RecordingReader first(options.first);
    const RecordingReader second(options.second);
    refuse_unlike(header_of(first), header_of(second), options.across_domains, options.across_runs);
    if (!std::ranges::equal(first.ids(), second.ids()))
      throw InputError(fmt::format(
          "{}: error: the recording has other bodies than {}: give two recordings of the same world",
          second.file().string(), first.file().string()));
    return compare_frames(first, second);
  } catch (const worldio::Hdf5Error& error) {
    throw InputError(error.what());
  }
}

}  // namespace troupe::apps
