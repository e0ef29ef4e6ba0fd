#include "render/osmesa_context.hpp"

#include "base/sanitizers.hpp"
#include "partition/job_thread.hpp"

#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <stdexcept>
#include <string>

#ifdef TROUPE_ADDRESS_SANITIZER
#include <sanitizer/lsan_interface.h>
#endif

namespace troupe::render {
namespace {

/// Mesa 22 leaks about 300 bytes per destroyed context. While an object of this type exists, the
/// address sanitizer ignores leaks.
struct ForgiveLeaks {
#ifdef TROUPE_ADDRESS_SANITIZER
  __lsan::ScopedDisabler disabler;
#endif
};

constexpr std::array k_library_names = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};

struct Osmesa {
  decltype(&OSMesaCreateContextAttribs) create;
  decltype(&OSMesaDestroyContext) destroy;
  decltype(&OSMesaMakeCurrent) make_current;
  decltype(&OSMesaGetProcAddress) get_procedure;
};

template <class Function>
Function symbol(void* library, const char* name) {
  void* const address = dlsym(library, name);
  if (!address) {
    throw std::runtime_error(
        fmt::format("cannot draw: the installed OSMesa has no function {}; OpenGL 3.3 needs Mesa 12 or later "
                    "(Debian, Ubuntu: apt install libosmesa6)",
                    name));
  }
  return reinterpret_cast<Function>(address);
}

// Address space that Mesa 22 takes for its first picture, measured with and without threads. Of the memory of
// a thread, most is what glibc reserves for its allocations.
constexpr std::size_t k_picture_bytes = std::size_t{176} << 20;
constexpr std::size_t k_thread_bytes = std::size_t{72} << 20;

/// Whether the process may use so many bytes of address space in addition to those in use.
bool has_room_for(std::size_t bytes) {
  void* const room = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return room != MAP_FAILED && munmap(room, bytes) == 0;
}

/// Throws std::runtime_error if the address space is too small for a picture (`ulimit -v`). Mesa does not
/// check whether it gets memory, so the program would crash.
void require_room_for_picture() {
  if (!has_room_for(k_picture_bytes))
    throw std::runtime_error(
        fmt::format("cannot draw: OSMesa needs {} MiB more memory (raise the limits on memory of this "
                    "process); maps as .svg or .pdf do not need OSMesa",
                    k_picture_bytes >> 20));
}

/// Lets Mesa draw without threads if the system does not allow all those that Mesa starts with the first
/// context, or not the memory of so many: Mesa 22 would wait for ever for the others, or crash. The pixels
/// are the same.
void draw_without_threads_if_too_few() {
  // Threads that draw and threads for compute shaders, each one per processor. Mesa 22 starts at most 16 of
  // each, Mesa 23 at most 32.
  constexpr long k_most_per_kind = 32;
  const long per_kind = std::clamp(sysconf(_SC_NPROCESSORS_ONLN), 1L, k_most_per_kind);
  const auto threads = static_cast<std::size_t>(2 * per_kind);
  if (!partition::try_threads(threads) && has_room_for(k_picture_bytes + threads * k_thread_bytes)) return;
  setenv("LP_NUM_THREADS", "0", 1);  // NOLINT(concurrency-mt-unsafe): Mesa has no other way to set this
}

const Osmesa& osmesa() {
  static const Osmesa functions = [] {
    void* const library = open_osmesa(k_library_names);
    require_room_for_picture();
    draw_without_threads_if_too_few();
    return Osmesa{symbol<decltype(Osmesa::create)>(library, "OSMesaCreateContextAttribs"),
                  symbol<decltype(Osmesa::destroy)>(library, "OSMesaDestroyContext"),
                  symbol<decltype(Osmesa::make_current)>(library, "OSMesaMakeCurrent"),
                  symbol<decltype(Osmesa::get_procedure)>(library, "OSMesaGetProcAddress")};
  }();
  return functions;
}

}  // namespace

void* open_osmesa(std::span<const char* const> library_names) {
  std::string reasons;
  for (const char* name : library_names) {
    if (void* const library = dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
    const char* const reason = dlerror();
    reasons += fmt::format("{}{}", reasons.empty() ? "" : "; ", reason ? reason : name);
  }
  const bool is_too_large = reasons.find("failed to map segment") != std::string::npos;
  throw std::runtime_error(
      fmt::format("cannot draw: {}: {}; maps as .svg or .pdf do not need OSMesa",
                  is_too_large ? "OSMesa cannot be loaded (raise the limits on memory of this process)"
                               : "OSMesa is not installed (Debian, Ubuntu: apt install libosmesa6)",
                  reasons));
}

OsmesaContext::OsmesaContext() {
  constexpr std::array<int, 9> k_attributes = {OSMESA_FORMAT,
                                               OSMESA_RGBA,
                                               OSMESA_PROFILE,
                                               OSMESA_CORE_PROFILE,
                                               OSMESA_CONTEXT_MAJOR_VERSION,
                                               3,
                                               OSMESA_CONTEXT_MINOR_VERSION,
                                               3,
                                               0};
  [[maybe_unused]] const ForgiveLeaks forgive;
  const OSMesaContext context = osmesa().create(k_attributes.data(), nullptr);
  if (!context)
    throw std::runtime_error(
        "cannot draw: the installed OSMesa cannot create an OpenGL 3.3 core context; install a newer version "
        "(Debian, Ubuntu: apt install libosmesa6)");
  context_ = context;
}

OsmesaContext::~OsmesaContext() { osmesa().destroy(static_cast<OSMesaContext>(context_)); }

void OsmesaContext::make_current() {
  [[maybe_unused]] const ForgiveLeaks forgive;
  const auto context = static_cast<OSMesaContext>(context_);
  if (!osmesa().make_current(context, window_.data(), GL_UNSIGNED_BYTE, 16, 16))
    throw std::runtime_error(
        "cannot draw: the installed OSMesa cannot activate its OpenGL context; install a newer version "
        "(Debian, Ubuntu: apt install libosmesa6)");
}

void OsmesaContext::release() { osmesa().make_current(nullptr, nullptr, 0, 0, 0); }

OsmesaContext::Procedure OsmesaContext::procedure(const char* name) const {
  const auto found = osmesa().get_procedure(name);
  if (!found)
    throw std::runtime_error(fmt::format(
        "cannot draw: the installed OSMesa has no OpenGL function {}; install a newer version", name));
  return reinterpret_cast<Procedure>(found);
}

}  // namespace troupe::render
