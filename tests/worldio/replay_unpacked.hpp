#pragma once

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// A decoder of the data in replay pages (HTML files that play a recording). It is made from the
/// specification in docs/replay.md, and shares no code with the encoder that the tests check.
namespace troupe::test {

inline std::string inflated(std::string_view bytes) {
  std::string out(1024 + 64 * bytes.size(), '\0');
  for (;;) {
    uLongf size = out.size();
    const int result = uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    if (result == Z_OK) {
      out.resize(size);
      return out;
    }
    if (result != Z_BUF_ERROR || out.size() > (std::size_t{1} << 30)) throw std::runtime_error("no zlib");
    out.resize(4 * out.size());
  }
}

inline constexpr std::int64_t k_gone = std::numeric_limits<std::int64_t>::min();

/// Decodes a stream of series (docs/replay.md). A series contains one value of one robot, such as x, in all
/// frames of a block. Each call of next() decodes the next series of the stream. The results are whole
/// numbers of steps, and k_gone for frames in which the value is absent. frames: number of frames in the
/// block. line: whether the values were encoded as differences from a linear extrapolation, as for poses;
/// false: from the previous value.
class Series {
 public:
  explicit Series(std::string bytes) : bytes_(std::move(bytes)) {}

  std::vector<std::int64_t> next(std::size_t frames, bool line) {
    std::vector<std::int64_t> values;
    std::vector<std::int64_t> known;  // since the last gap, which begins with the value before it
    for (std::size_t f = 0; f < frames; ++f) {
      const std::uint64_t code = number();
      if (code == 0) {
        values.push_back(k_gone);
        if (!known.empty()) known = {known.back()};
        continue;
      }
      const auto d = static_cast<std::int64_t>((code - 1) / 2);
      const std::int64_t off = (code - 1) % 2 == 0 ? d : -d - 1;
      std::int64_t expected = known.empty() ? 0 : known.back();
      if (line && known.size() > 1) expected += known.back() - known[known.size() - 2];
      values.push_back(expected + off);
      // The first value behind a gap, or of all, says nothing about a speed.
      const bool begins = f == 0 || values[f - 1] == k_gone;
      if (begins) known.clear();
      known.push_back(values.back());
    }
    return values;
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  std::uint64_t number() {
    std::uint64_t number = 0;
    for (int shift = 0;; shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes_.at(at_++));
      number |= std::uint64_t{byte & 127u} << shift;
      if (byte < 128) return number;
    }
  }

  std::string bytes_;
  std::size_t at_ = 0;
};

/// The decoded data of a replay page.
struct Unpacked {
  nlohmann::json header;
  using Table = std::vector<std::vector<double>>;  ///< [frame][robot x columns + column]; NaN: no value
  Table x, y, heading, z;
  std::vector<Table> fields;
};

inline Unpacked unpacked(std::string_view bytes) {
  const auto byte = [&](std::size_t i) { return std::size_t{static_cast<unsigned char>(bytes.at(i))}; };
  const std::size_t length = byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
  Unpacked page;
  page.header = nlohmann::json::parse(inflated(bytes.substr(4, length)));
  const auto& header = page.header;
  const std::size_t frames = header.at("times_s").size();
  const std::size_t robots = header.at("robots").at("id").size();
  const std::size_t block_frames = header.at("block_frames").get<std::size_t>();
  page.fields.resize(header.at("fields").size());

  const auto add = [](Unpacked::Table& table, std::size_t first, const std::vector<std::int64_t>& series,
                      double from, double step) {
    table.resize(std::max(table.size(), first + series.size()));
    for (std::size_t f = 0; f < series.size(); ++f)
      table[first + f].push_back(series[f] == k_gone ? std::nan("")
                                                     : from + static_cast<double>(series[f]) * step);
  };
  std::size_t at = 4 + length;
  std::size_t first = 0;
  for (const auto& streams : header.at("block_bytes")) {
    const std::size_t count = std::min(block_frames, frames - first);
    for (std::size_t s = 0; s < streams.size(); ++s) {
      const std::size_t size = streams[s].get<std::size_t>();
      Series series(inflated(bytes.substr(at, size)));
      at += size;
      if (s == 0) {
        const double step = header.at("pose").at("step_m").get<double>();
        const double turn = 2 * 3.14159265358979 / header.at("pose").at("turn").get<double>();
        for (std::size_t r = 0; r < robots; ++r) add(page.x, first, series.next(count, true), 0, step);
        for (std::size_t r = 0; r < robots; ++r) add(page.y, first, series.next(count, true), 0, step);
        for (std::size_t r = 0; r < robots; ++r) add(page.heading, first, series.next(count, true), 0, turn);
        if (header.at("pose").at("has_z").get<bool>())
          for (std::size_t r = 0; r < robots; ++r) add(page.z, first, series.next(count, true), 0, step);
      } else {
        const auto& field = header.at("fields").at(s - 1);
        while (!series.at_end())
          add(page.fields[s - 1], first, series.next(count, false), field.at("min").get<double>(),
              field.at("step").get<double>());
      }
      EXPECT_TRUE(series.at_end());
    }
    first += count;
  }
  EXPECT_EQ(first, frames);
  EXPECT_EQ(at, bytes.size());
  return page;
}

}  // namespace troupe::test
