#include "worldio/results/replay_data.hpp"

#include "base/diagnostics.hpp"
#include "worldio/results/little_endian.hpp"
#include "worldio/results/replay_codec.hpp"
#include "worldio/results/replay_header.hpp"
#include "worldio/results/replay_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

// Limits of the number of frames in a block. A block is large enough that its first frame, which is stored
// without prediction, adds little to its size. It is small enough that a browser unpacks it in the time
// between two pictures.
constexpr std::size_t k_block_poses = 2000000;
constexpr std::size_t k_block_values = 16000000;  // values of the largest field in a block
constexpr std::size_t k_least_block = 4;
constexpr std::size_t k_most_block = 256;

std::size_t block_frames(const ReplayPlan& plan) {
  std::size_t widest = plan.order.size();
  for (const ReplayField& field : plan.fields)
    widest = std::max(widest, field.rows.size() * field.array->field.columns);
  const std::size_t frames = std::min(k_block_poses / plan.order.size(), k_block_values / widest);
  return std::clamp(frames, k_least_block, k_most_block);
}

/// Returns the indices of every stride-th frame and of the last frame.
std::vector<std::size_t> chosen_frames(std::size_t recorded, std::size_t stride) {
  std::vector<std::size_t> frames;
  for (std::size_t frame = 0; frame < recorded; frame += stride) frames.push_back(frame);
  if (frames.back() != recorded - 1) frames.push_back(recorded - 1);
  return frames;
}

std::int32_t in_steps(double value, double step) {
  if (!std::isfinite(value)) return k_absent;
  constexpr auto k_most = static_cast<double>(k_most_in_series);
  return static_cast<std::int32_t>(std::llround(std::clamp(value / step, -k_most, k_most)));
}

/// Makes a series of headings continuous where it jumps from half a turn to minus half a turn, or back.
void unwrap(std::span<std::int32_t> series) {
  std::int32_t last = 0;
  for (std::int32_t& value : series) {
    if (value == k_absent) continue;
    const std::int32_t turned = (value - last) % k_replay_turn;
    value = last + (turned > k_replay_turn / 2    ? turned - k_replay_turn
                    : turned < -k_replay_turn / 2 ? turned + k_replay_turn
                                                  : turned);
    last = value;
  }
}

/// Encodes the data of a replay page (an HTML file that shows a recording), block after block. A block is a
/// number of consecutive frames. A stream is the data of one field, or of the poses, in one block.
class BlockWriter {
 public:
  BlockWriter(const RecordingReader& recording, const ReplayPlan& plan) : plan_(plan), reader_(recording) {}

  /// Returns the stream of the poses in a block: first x of each robot over all frames of the block, then in
  /// the same way y, heading and, if heights change, z.
  std::string poses(std::span<const std::size_t> frames) {
    packed_.clear();
    const std::array<double, 4> steps{k_replay_step_m, k_replay_step_m, 2 * k_pi / k_replay_turn,
                                      k_replay_step_m};
    for (std::size_t axis = 0; axis < steps.size(); ++axis) {
      if (!plan_.pose[axis]) continue;
      gather(*plan_.pose[axis], plan_.order, frames, 0, steps[axis]);
      for (std::size_t row = 0; row < plan_.order.size(); ++row) {
        const std::span series = std::span(values_).subspan(row * frames.size(), frames.size());
        if (axis == 2) unwrap(series);
        append_series(series, Expected::line, packed_);
      }
    }
    return deflated(packed_);
  }

  /// Returns the stream of one field in a block: for each row of the field and each of its columns, the
  /// values over all frames of the block.
  std::string field(const ReplayField& field, std::span<const std::size_t> frames) {
    packed_.clear();
    gather(*field.array, field.rows, frames, field.min, field.step);
    for (std::size_t at = 0; at < values_.size(); at += frames.size())
      append_series(std::span(values_).subspan(at, frames.size()), Expected::same, packed_);
    return deflated(packed_);
  }

 private:
  /// Fills values_[(row * columns + column) * frames + frame] with the values of the given rows of an array.
  /// Each value is stored as the number of steps of size `step` above `from`.
  void gather(const RecordingReader::Array& array, std::span<const std::uint32_t> rows,
              std::span<const std::size_t> frames, double from, double step) {
    const std::size_t columns = array.field.columns;
    values_.resize(rows.size() * columns * frames.size());
    for (std::size_t frame = 0; frame < frames.size(); ++frame) {
      reader_.read(array, frames[frame], frame_);
      std::size_t to = frame;
      for (const std::uint32_t row : rows)
        for (std::size_t column = 0; column < columns; ++column, to += frames.size())
          values_[to] = in_steps(frame_[row * columns + column] - from, step);
    }
  }

  const ReplayPlan& plan_;
  FrameReader reader_;
  std::vector<double> frame_;
  std::vector<std::int32_t> values_;
  std::string packed_;
};

/// Returns the data of a page: the length of the compressed header (4 bytes, little-endian), this header, and
/// the streams of all blocks.
std::string packed(const RecordingReader& recording, const ReplayPlan& plan,
                   std::span<const std::size_t> frames, const ReplayBlocks& blocks,
                   const std::string& streams) {
  const std::string header = deflated(replay_header(recording, plan, frames, blocks));
  std::array<std::uint8_t, 4> length;
  put_little_endian(header.size(), length);
  return std::string(length.begin(), length.end()) + header + streams;
}

/// The result of an attempt to make a page: its data or, if the page would be too large, the factor by which
/// it would exceed the limit.
struct Try {
  std::optional<std::string> bytes;
  double excess = 1;
};

Try make(const RecordingReader& recording, const ReplayPlan& plan, std::span<const std::size_t> frames,
         std::size_t most_bytes) {
  BlockWriter writer(recording, plan);
  ReplayBlocks blocks{.frames = block_frames(plan)};
  // The size of the constant data is checked first, because with thousands of types it is most of a page.
  const std::size_t fixed_bytes = packed(recording, plan, frames, blocks, "").size();
  const auto excess_of = [&](std::size_t stream_bytes, std::size_t done) {
    const double room = static_cast<double>(most_bytes) - static_cast<double>(fixed_bytes);
    const double share = static_cast<double>(done) / static_cast<double>(frames.size());
    return static_cast<double>(stream_bytes) / share / std::max(room, 1.0);
  };
  std::string streams;
  for (std::size_t first = 0; first < frames.size(); first += blocks.frames) {
    const auto block = frames.subspan(first, std::min(blocks.frames, frames.size() - first));
    std::vector<std::size_t>& bytes = blocks.bytes.emplace_back();
    const auto add = [&](const std::string& stream) {
      bytes.push_back(stream.size());
      streams += stream;
    };
    add(writer.poses(block));
    for (const ReplayField& field : plan.fields) add(writer.field(field, block));
    if (fixed_bytes + streams.size() > most_bytes)
      return {.excess = excess_of(streams.size(), first + block.size())};
  }
  std::string bytes = packed(recording, plan, frames, blocks, streams);
  if (bytes.size() > most_bytes) return {.excess = excess_of(streams.size(), frames.size())};
  return {.bytes = std::move(bytes)};
}

/// Returns the next stride to try if `stride` gave a page that was too large by the factor `excess`.
std::size_t next_stride(std::size_t stride, double excess, std::size_t recorded) {
  const double wanted = std::ceil(static_cast<double>(stride) * excess);
  const auto most = static_cast<double>(std::max<std::size_t>(recorded, 2) - 1);
  return std::max(stride + 1, static_cast<std::size_t>(std::min(wanted, most)));
}

}  // namespace

ReplayData replay_data(const RecordingReader& recording, const ReplayOptions& options) {
  const ReplayPlan plan = plan_replay(recording, options.fields);
  ReplayData data{.recorded = recording.frames(), .at_rest = plan.at_rest};
  for (const std::uint32_t id : recording.ids())
    ++(plan.scene.types[plan.scene.bodies[id].type].look.mobile ? data.robots : data.others);
  for (;;) {  // the stride grows, so this loop ends
    const std::vector<std::size_t> frames = chosen_frames(data.recorded, data.stride);
    Try page = make(recording, plan, frames, options.most_bytes);
    if (page.bytes) {
      data.bytes = std::move(*page.bytes);
      data.frames = frames.size();
      if (frames.size() > 1) data.every_s = recording.times_s()[frames[1]] - recording.times_s()[frames[0]];
      return data;
    }
    if (frames.size() <= 2)
      throw InputError(
          fmt::format("{}: error: the replay page is too small for even two frames (bodies per frame: {}): "
                      "allow a larger page with --max-mb, or show fewer fields with --fields pose",
                      recording.file().string(), plan.order.size()));
    data.stride = next_stride(data.stride, page.excess, data.recorded);
  }
}

}  // namespace troupe::worldio
