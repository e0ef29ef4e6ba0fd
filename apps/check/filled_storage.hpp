#pragma once

#include <cstddef>

namespace troupe::apps {

/// While one lives, whatever `new` hands out in this process is filled with its byte first, on any thread: a
/// member that is never set then has a value that is known to be junk, and another one under another byte.
/// Over-aligned types are left out. One at a time.
class FilledStorage {
 public:
  explicit FilledStorage(std::byte byte);
  ~FilledStorage();
  FilledStorage(const FilledStorage&) = delete;
  FilledStorage& operator=(const FilledStorage&) = delete;
};

}  // namespace troupe::apps
