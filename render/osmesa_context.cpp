#include "render/osmesa_context.hpp"

#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <stdexcept>
#include <string>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace troupe::render {
namespace {

/// Mesa 22 leaks about 300 bytes per destroyed context. While an object of this type exists, the
/// address sanitizer ignores leaks.
struct ForgiveLeaks {
#ifdef __SANITIZE_ADDRESS__
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

const Osmesa& osmesa() {
  static const Osmesa functions = [] {
    void* const library = open_osmesa(k_library_names);
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
  throw std::runtime_error(
      fmt::format("cannot draw: OSMesa is not installed (Debian, Ubuntu: apt install libosmesa6): {}; "
                  "maps as .svg or .pdf do not need OSMesa",
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
