#pragma once

#include <cstddef>

namespace troupe::apps {

/// While an object of this class lives, `new` fills all memory that it returns in this process, on any
/// thread, with the byte `byte`. A member that is not initialised then has a known wrong value, which depends
/// on `byte`. Memory for over-aligned types is not filled. At most one object may live at a time.
class FilledStorage {
 public:
  explicit FilledStorage(std::byte byte);
  ~FilledStorage();
  FilledStorage(const FilledStorage&) = delete;
  FilledStorage& operator=(const FilledStorage&) = delete;
};

}  // namespace troupe::apps
