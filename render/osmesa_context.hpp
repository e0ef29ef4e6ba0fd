#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace troupe::render {

/// An OpenGL 3.3 core context without a window.
/// OSMesa is loaded with the first context and stays loaded. It is not linked, because that would cost every
/// run without pictures 57 MB and 26 ms.
class OsmesaContext {
 public:
  /// Throws std::runtime_error, with the package to install, if OSMesa is missing or too old.
  OsmesaContext();
  ~OsmesaContext();
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  /// Makes this context current on the calling thread until release(); it can be current on only one thread
  /// at a time. Throws std::runtime_error.
  void make_current();
  void release();

  using Procedure = void (*)();
  /// An OpenGL function by name, such as "glClear", valid for all contexts. Throws std::runtime_error if the
  /// library has no such function.
  Procedure procedure(const char* name) const;

 private:
  void* context_ = nullptr;
  std::array<std::uint8_t, 16 * 16 * 4>
      window_;  // required by OSMesa; pictures are drawn into framebuffer objects
};

/// Opens the first library that can be loaded and returns its handle, which is never closed. Throws
/// std::runtime_error with the package to install and the loader's messages if none can.
void* open_osmesa(std::span<const char* const> library_names);

}  // namespace troupe::render
