#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace troupe::render {

/// An OpenGL 3.3 core context without a window, provided by the library OSMesa. OSMesa is loaded with the
/// first context and stays loaded. The library is not linked, because linking would cost every run of a
/// program about 57 MB of memory and 26 ms of start-up time, even if it draws no pictures.
///
/// If the system does not allow the threads with which OSMesa draws, the first context sets the environment
/// variable LP_NUM_THREADS of the process to 0, and OSMesa draws on the calling threads.
class OsmesaContext {
 public:
  /// Creates a context, which is not current on any thread. Throws std::runtime_error if OSMesa is missing or
  /// too old. The message names the package to install.
  OsmesaContext();
  ~OsmesaContext();
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  /// Makes this context current on the calling thread until release() is called. A context can be current on
  /// only one thread at a time. Throws std::runtime_error if OSMesa fails.
  void make_current();
  /// Ends make_current(): no context is then current on the calling thread. Call it on the same thread as
  /// make_current(), and before the destructor.
  void release();

  using Procedure = void (*)();
  /// Returns the OpenGL function with this name, such as "glClear". The caller must cast it to its true type.
  /// The function is valid for all contexts. Throws std::runtime_error if the library has no such function.
  Procedure procedure(const char* name) const;

 private:
  void* context_ = nullptr;
  // Required by OSMesa. Pictures are drawn into framebuffer objects.
  std::array<std::uint8_t, 16 * 16 * 4> window_;
};

/// Opens the first library of `library_names` that can be loaded and returns its handle (of dlopen()), which
/// is never closed. If none can be loaded, throws std::runtime_error; the message contains the messages of
/// the loader, and names the package to install, or says that the limits on memory are too low.
void* open_osmesa(std::span<const char* const> library_names);

}  // namespace troupe::render
