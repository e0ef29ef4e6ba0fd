#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// A row, and a pose for its body.
struct Placed {
  Row row;    ///< row of the body
  Pose pose;  ///< world frame, m and rad; the heading may have any finite value and is wrapped
};

/// Rows whose bodies a program has placed, each once, with the poses of the bodies. Finding a row takes
/// constant time.
class PlacedRows {
 public:
  /// Reserves memory, so that the rows 0 to `rows` - 1 can be found without further allocations.
  void reserve(std::size_t rows) { at_.resize(std::max(at_.size(), rows)); }
  /// Adds a row, or replaces its pose.
  void set(Row row, const Pose& pose) {
    reserve(row.index() + 1);
    std::uint32_t& at = at_[row.index()];
    if (at == 0) {
      list_.push_back({row, {}});
      at = static_cast<std::uint32_t>(list_.size());
    }
    list_[at - 1].pose = pose;
  }
  /// Returns the pose of a row; null if the row is not listed.
  const Pose* find(Row row) const {
    const std::uint32_t at = row.index() < at_.size() ? at_[row.index()] : 0;
    return at == 0 ? nullptr : &list_[at - 1].pose;
  }
  std::span<const Placed> all() const { return list_; }  ///< in the order in which the rows were added
  /// Removes all rows.
  void clear() {
    for (const Placed& placed : list_) at_[placed.row.index()] = 0;
    list_.clear();
  }
  /// Exchanges the contents of two lists.
  void swap(PlacedRows& other) {
    list_.swap(other.list_);
    at_.swap(other.at_);
  }

  /// Called when the bodies get other rows: row r becomes to[r].
  void move_rows(std::span<const std::uint32_t> to) {
    const auto move = [&] {
      for (Placed& placed : list_) placed.row = Row(to[placed.row.index()]);
    };
    change(move);
  }
  /// Removes the rows from `rows` on.
  void keep_rows(std::size_t rows) {
    change([&] { std::erase_if(list_, [&](const Placed& placed) { return placed.row.index() >= rows; }); });
  }

 private:
  /// Calls work(), which changes list_, and brings at_ up to date.
  template <class Work>
  void change(Work&& work) {
    for (const Placed& placed : list_) at_[placed.row.index()] = 0;
    work();
    for (std::uint32_t i = 0; i < list_.size(); ++i) {
      reserve(list_[i].row.index() + 1);
      at_[list_[i].row.index()] = i + 1;
    }
  }

  std::vector<Placed> list_;
  std::vector<std::uint32_t> at_;  // per row: its place in list_, counted from 1; 0: not listed
};

}  // namespace troupe::engine
