#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace troupe::render {

/// The functions of a library that provides OpenGL contexts without a window.
class OffscreenLibrary;

/// An OpenGL 3.3 core context without a window, drawn on the processor by Mesa. The library that provides it
/// is chosen with the first context and stays loaded: OSMesa or, where it is not installed, EGL. (Mesa 25.1
/// and later have no OSMesa.) Both contain the same renderer, llvmpipe, and give the same pixels. The
/// libraries are not linked, because linking would cost every run of a program about 57 MB of memory and 26
/// ms of start-up time, even if it draws no pictures.
///
/// If the system does not allow the threads with which Mesa draws, the first context sets the environment
/// variable LP_NUM_THREADS of the process to 0, and Mesa draws on the calling threads.
class OffscreenContext {
 public:
  /// Creates a context, which is not current on any thread. Throws std::runtime_error if neither library is
  /// installed, or if the library is too old. The message names the package to install.
  OffscreenContext();
  /// As above, from this library (open_osmesa(), open_egl()).
  explicit OffscreenContext(std::shared_ptr<const OffscreenLibrary> library);
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// Makes this context current on the calling thread until release() is called. A context can be current on
  /// only one thread at a time. Throws std::runtime_error if the library fails.
  void make_current();
  /// Ends make_current(): no context is then current on the calling thread. Call it on the same thread as
  /// make_current(), and before the destructor.
  void release();

  using Procedure = void (*)();
  /// Returns the OpenGL function with this name, such as "glClear". The caller must cast it to its true type.
  /// The function is valid for all contexts. Throws std::runtime_error if the library has no such function.
  Procedure procedure(const char* name) const;

 private:
  std::shared_ptr<const OffscreenLibrary> library_;
  void* context_ = nullptr;
  // Required by OSMesa. Pictures are drawn into framebuffer objects.
  std::array<std::uint8_t, 16 * 16 * 4> window_;
};

/// Opens the first library of `names` that can be loaded, as OSMesa or as EGL. It is never closed. Returns
/// null if none is installed, and appends the messages of the loader to `reasons`. Throws std::runtime_error
/// if the limits on memory are too low, or if the library is too old.
///
/// With EGL, contexts are those of Mesa's software device, never of a graphics card, which other programs may
/// need, and whose pixels differ from model to model. Throws std::runtime_error if EGL has no such device.
///@{
std::shared_ptr<const OffscreenLibrary> open_osmesa(std::span<const char* const> names, std::string& reasons);
std::shared_ptr<const OffscreenLibrary> open_egl(std::span<const char* const> names, std::string& reasons);
///@}

}  // namespace troupe::render
