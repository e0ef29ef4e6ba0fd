#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace troupe::render {

/// An OpenGL 3.3 core context without a window.
/// OSMesa is loaded when the first one is made and stays loaded. It is never linked: that would cost every
/// run without pictures 57 MB and 26 ms.
class OsmesaContext {
 public:
  /// Throws std::runtime_error, naming the package to install, where there is no OSMesa that can do this.
  OsmesaContext();
  ~OsmesaContext();
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  /// From here on OpenGL of the calling thread is this context's, until release(); of one thread at a time.
  /// Throws std::runtime_error.
  void make_current();
  void release();

  using Procedure = void (*)();
  /// An OpenGL entry point by its name, "glClear", of all contexts. Throws std::runtime_error when the
  /// library has none.
  Procedure procedure(const char* name) const;

 private:
  void* context_ = nullptr;
  std::array<std::uint8_t, 16 * 16 * 4> window_;  // OSMesa asks for one; pictures go to framebuffer objects
};

/// The handle of the first library that can be opened; it is never closed.
/// Throws std::runtime_error with the package to install and the loader's words when none can.
void* open_osmesa(std::span<const char* const> library_names);

}  // namespace troupe::render
