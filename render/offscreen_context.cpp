#include "render/offscreen_context.hpp"

#include "base/sanitizers.hpp"
#include "partition/job_thread.hpp"

#include <GL/gl.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#ifdef TROUPE_ADDRESS_SANITIZER
#include <sanitizer/lsan_interface.h>
#endif

namespace troupe::render {

class OffscreenLibrary {
 public:
  OffscreenLibrary() = default;
  virtual ~OffscreenLibrary() = default;
  OffscreenLibrary(const OffscreenLibrary&) = delete;
  OffscreenLibrary& operator=(const OffscreenLibrary&) = delete;

  virtual const char* name() const = 0;
  /// Creates a context; null if the library cannot create one of OpenGL 3.3 core.
  virtual void* create() const = 0;
  virtual void destroy(void* context) const = 0;
  /// Makes a context current on the calling thread, or none if it is null. window: bytes of a window of 16 x
  /// 16 pixels, which OSMesa needs. Returns whether it succeeded.
  virtual bool make_current(void* context, std::uint8_t* window) const = 0;
  virtual OffscreenContext::Procedure procedure(const char* name) const = 0;
};

namespace {

/// Mesa 22 leaks about 300 bytes per destroyed context. While an object of this type exists, the
/// address sanitizer ignores leaks.
struct ForgiveLeaks {
#ifdef TROUPE_ADDRESS_SANITIZER
  __lsan::ScopedDisabler disabler;
#endif
};

constexpr std::array k_osmesa_names = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
constexpr std::array k_egl_names = {"libEGL.so.1"};

template <class Function>
Function symbol(void* library, const char* name) {
  void* const address = dlsym(library, name);
  if (!address) {
    throw std::runtime_error(fmt::format(
        "cannot draw: the installed OSMesa or EGL has no function {}; OpenGL 3.3 needs Mesa 12 or "
        "later: install a newer version",
        name));
  }
  return reinterpret_cast<Function>(address);
}

// Address space that Mesa 22 takes for its first picture, measured with and without threads. Of the memory of
// a thread, most is what glibc reserves for its allocations.
constexpr std::size_t k_picture_bytes = std::size_t{176} << 20;
constexpr std::size_t k_thread_bytes = std::size_t{72} << 20;
// What EGL loads after itself: the driver with its compiler. OSMesa contains them.
constexpr std::size_t k_driver_bytes = std::size_t{160} << 20;

/// Whether the process may use so many bytes of address space in addition to those in use.
bool has_room_for(std::size_t bytes) {
  void* const room = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return room != MAP_FAILED && munmap(room, bytes) == 0;
}

/// Throws std::runtime_error if the address space is too small for a picture (`ulimit -v`), which needs so
/// many bytes. Mesa does not check whether it gets memory, so the program would crash.
void require_room_for_picture(std::size_t bytes) {
  if (!has_room_for(bytes))
    throw std::runtime_error(
        fmt::format("cannot draw: Mesa needs {} MiB more memory (raise the limits on memory of this "
                    "process); maps as .svg or .pdf do not need it",
                    bytes >> 20));
}

/// Lets Mesa draw without threads if the system does not allow all those that Mesa starts with the first
/// context, or not the memory of so many: Mesa 22 would wait for ever for the others, or crash. The pixels
/// are the same. picture_bytes: memory that Mesa needs without threads
void draw_without_threads_if_too_few(std::size_t picture_bytes) {
  // Threads that draw and threads for compute shaders, each one per processor. Mesa 22 starts at most 16 of
  // each, Mesa 23 at most 32.
  constexpr long k_most_per_kind = 32;
  const long per_kind = std::clamp(sysconf(_SC_NPROCESSORS_ONLN), 1L, k_most_per_kind);
  const auto threads = static_cast<std::size_t>(2 * per_kind);
  if (!partition::try_threads(threads) && has_room_for(picture_bytes + threads * k_thread_bytes)) return;
  setenv("LP_NUM_THREADS", "0", 1);  // NOLINT(concurrency-mt-unsafe): Mesa has no other way to set this
}

// NOLINTBEGIN(concurrency-mt-unsafe): Mesa has no other way to choose a driver
/// While an object of this class exists, the variables of the environment with which users choose a driver of
/// Mesa, which may draw on a graphics card, are not set. Mesa reads them with the first context.
class NoChosenDriver {
 public:
  NoChosenDriver() {
    for (std::size_t i = 0; i < k_variables.size(); ++i) {
      if (const char* value = std::getenv(k_variables[i])) values_[i] = value;
      unsetenv(k_variables[i]);
    }
  }
  ~NoChosenDriver() {
    for (std::size_t i = 0; i < k_variables.size(); ++i)
      if (values_[i]) setenv(k_variables[i], values_[i]->c_str(), 1);
  }
  NoChosenDriver(const NoChosenDriver&) = delete;
  NoChosenDriver& operator=(const NoChosenDriver&) = delete;

 private:
  static constexpr std::array k_variables{"GALLIUM_DRIVER", "MESA_LOADER_DRIVER_OVERRIDE"};
  std::array<std::optional<std::string>, k_variables.size()> values_;
};
// NOLINTEND(concurrency-mt-unsafe)

/// Opens the first library that can be loaded; null if there is none. what: "OSMesa" or "EGL". picture_bytes:
/// address space that the library then needs for its first picture
void* open_library(std::span<const char* const> names, std::string_view what, std::size_t picture_bytes,
                   std::string& reasons) {
  std::string here;
  for (const char* name : names) {
    if (void* const library = dlopen(name, RTLD_NOW | RTLD_LOCAL)) {
      require_room_for_picture(picture_bytes);
      draw_without_threads_if_too_few(picture_bytes);
      return library;
    }
    const char* const reason = dlerror();
    here += fmt::format("{}{}", here.empty() ? "" : "; ", reason ? reason : name);
  }
  if (here.find("failed to map segment") != std::string::npos)
    throw std::runtime_error(fmt::format(
        "cannot draw: {} cannot be loaded (raise the limits on memory of this process): {}; maps as "
        ".svg or .pdf do not need it",
        what, here));
  reasons += fmt::format("{}{}", reasons.empty() ? "" : "; ", here);
  return nullptr;
}

/// OSMesa, whose header (GL/osmesa.h) is not needed: Mesa 25.1 and later have none.
class Osmesa : public OffscreenLibrary {
 public:
  explicit Osmesa(void* library)
      : create_(symbol<Create>(library, "OSMesaCreateContextAttribs")),
        destroy_(symbol<Destroy>(library, "OSMesaDestroyContext")),
        make_current_(symbol<MakeCurrent>(library, "OSMesaMakeCurrent")),
        procedure_(symbol<GetProcedure>(library, "OSMesaGetProcAddress")) {}
  const char* name() const override { return "OSMesa"; }
  void* create() const override {
    constexpr int k_format = 0x22;
    constexpr int k_profile = 0x33;
    constexpr int k_core_profile = 0x34;
    constexpr int k_major = 0x36;
    constexpr int k_minor = 0x37;
    constexpr std::array k_attributes{k_format, GL_RGBA, k_profile, k_core_profile, k_major, 3,
                                      k_minor,  3,       0};
    return create_(k_attributes.data(), nullptr);
  }
  void destroy(void* context) const override { destroy_(context); }
  bool make_current(void* context, std::uint8_t* window) const override {
    if (!context) return make_current_(nullptr, nullptr, 0, 0, 0) != GL_FALSE;
    return make_current_(context, window, GL_UNSIGNED_BYTE, 16, 16) != GL_FALSE;
  }
  OffscreenContext::Procedure procedure(const char* name) const override { return procedure_(name); }

 private:
  using Create = void* (*)(const int* attributes, void* shared);
  using Destroy = void (*)(void* context);
  using MakeCurrent = GLboolean (*)(void* context, void* window, GLenum type, GLsizei width, GLsizei height);
  using GetProcedure = OffscreenContext::Procedure (*)(const char* name);
  Create create_;
  Destroy destroy_;
  MakeCurrent make_current_;
  GetProcedure procedure_;
};

/// EGL with Mesa's software device and contexts without a surface. EGL's header is not needed either.
class Egl : public OffscreenLibrary {
 public:
  explicit Egl(void* library)
      : procedure_(symbol<GetProcedure>(library, "eglGetProcAddress")),
        bind_(function<Bind>("eglBindAPI")),
        create_(function<Create>("eglCreateContext")),
        destroy_(function<Destroy>("eglDestroyContext")),
        make_current_(function<MakeCurrent>("eglMakeCurrent")),
        display_(software_display()) {}
  const char* name() const override { return "EGL"; }
  void* create() const override {
    constexpr int k_major = 0x3098;
    constexpr int k_minor = 0x30fb;
    constexpr int k_profile = 0x30fd;
    constexpr int k_core_profile = 1;
    constexpr std::array k_attributes{k_major, 3, k_minor, 3, k_profile, k_core_profile, k_none};
    bind_(k_opengl);
    return create_(display_, nullptr, nullptr, k_attributes.data());
  }
  void destroy(void* context) const override { destroy_(display_, context); }
  bool make_current(void* context, std::uint8_t* /*window*/) const override {
    bind_(k_opengl);  // each thread begins with OpenGL ES
    return make_current_(display_, nullptr, nullptr, context) != 0;
  }
  OffscreenContext::Procedure procedure(const char* name) const override { return procedure_(name); }

 private:
  using GetProcedure = OffscreenContext::Procedure (*)(const char* name);
  using Bind = unsigned (*)(unsigned api);
  using Create = void* (*)(void* display, void* config, void* shared, const int* attributes);
  using Destroy = unsigned (*)(void* display, void* context);
  using MakeCurrent = unsigned (*)(void* display, void* draw, void* read, void* context);
  using QueryDevices = unsigned (*)(int most, void** devices, int* count);
  using QueryDevice = const char* (*)(void* device, int name);
  using GetDisplay = void* (*)(unsigned platform, void* native, const int* attributes);
  using Initialize = unsigned (*)(void* display, int* major, int* minor);
  static constexpr unsigned k_opengl = 0x30a2;
  static constexpr int k_none = 0x3038;

  template <class Function>
  Function function(const char* name) const {
    const auto found = procedure_(name);
    if (!found)
      throw std::runtime_error(fmt::format(
          "cannot draw: the installed EGL has no function {}: install a newer version of Mesa", name));
    return reinterpret_cast<Function>(found);
  }

  /// Opens the display of the software device. The display of any other device would draw on a graphics card.
  void* software_display() const {
    constexpr int k_extensions = 0x3055;
    constexpr unsigned k_platform_device = 0x313f;
    constexpr int k_most_devices = 64;
    const auto query_device = function<QueryDevice>("eglQueryDeviceStringEXT");
    std::vector<void*> devices(k_most_devices);
    int count = 0;
    if (function<QueryDevices>("eglQueryDevicesEXT")(k_most_devices, devices.data(), &count) == 0) count = 0;
    devices.resize(static_cast<std::size_t>(count));
    for (void* device : devices) {
      const char* const extensions = query_device(device, k_extensions);
      if (!extensions ||
          std::string_view(extensions).find("EGL_MESA_device_software") == std::string_view::npos)
        continue;
      void* const display =
          function<GetDisplay>("eglGetPlatformDisplayEXT")(k_platform_device, device, nullptr);
      if (display && function<Initialize>("eglInitialize")(display, nullptr, nullptr) != 0) return display;
    }
    throw std::runtime_error(
        "cannot draw: the installed EGL has no software device of Mesa (Debian, Ubuntu: apt install libegl1 "
        "libgl1-mesa-dri); maps as .svg or .pdf do not need it");
  }

  GetProcedure procedure_;
  Bind bind_;
  Create create_;
  Destroy destroy_;
  MakeCurrent make_current_;
  void* display_;
};

/// Throws std::runtime_error if a library does not draw on the processor. Creates its first context.
void require_software(const std::shared_ptr<const OffscreenLibrary>& library) {
  OffscreenContext context(library);
  context.make_current();
  const auto get_string = reinterpret_cast<const GLubyte* (*)(GLenum)>(context.procedure("glGetString"));
  const auto* const text = reinterpret_cast<const char*>(get_string(GL_RENDERER));
  const std::string renderer = text ? text : "an unknown renderer";
  context.release();
  if (renderer.starts_with("llvmpipe") || renderer.starts_with("softpipe")) return;
  throw std::runtime_error(fmt::format(
      "cannot draw: the installed {} would draw with {}, not with Mesa's software renderer llvmpipe",
      library->name(), renderer));
}

std::shared_ptr<const OffscreenLibrary> chosen_library() {
  static const std::shared_ptr<const OffscreenLibrary> library = [] {
    std::string reasons;
    std::shared_ptr<const OffscreenLibrary> found = open_osmesa(k_osmesa_names, reasons);
    if (!found) found = open_egl(k_egl_names, reasons);
    if (found) return found;
    throw std::runtime_error(fmt::format(
        "cannot draw: neither OSMesa nor EGL is installed (Debian, Ubuntu: apt install libosmesa6 or, "
        "where there is no such package, libegl1): {}; maps as .svg or .pdf need neither",
        reasons));
  }();
  return library;
}

}  // namespace

std::shared_ptr<const OffscreenLibrary> open_osmesa(std::span<const char* const> names,
                                                    std::string& reasons) {
  [[maybe_unused]] const ForgiveLeaks forgive;
  const NoChosenDriver no_driver;
  void* const library = open_library(names, "OSMesa", k_picture_bytes, reasons);
  if (!library) return nullptr;
  auto osmesa = std::make_shared<Osmesa>(library);
  require_software(osmesa);
  return osmesa;
}

std::shared_ptr<const OffscreenLibrary> open_egl(std::span<const char* const> names, std::string& reasons) {
  [[maybe_unused]] const ForgiveLeaks forgive;
  const NoChosenDriver no_driver;
  void* const library = open_library(names, "EGL", k_picture_bytes + k_driver_bytes, reasons);
  if (!library) return nullptr;
  auto egl = std::make_shared<Egl>(library);
  require_software(egl);
  return egl;
}

OffscreenContext::OffscreenContext() : OffscreenContext(chosen_library()) {}

OffscreenContext::OffscreenContext(std::shared_ptr<const OffscreenLibrary> library)
    : library_(std::move(library)) {
  [[maybe_unused]] const ForgiveLeaks forgive;
  context_ = library_->create();
  if (!context_)
    throw std::runtime_error(
        fmt::format("cannot draw: the installed {} cannot create an OpenGL 3.3 core context: install a newer "
                    "version of Mesa",
                    library_->name()));
}

OffscreenContext::~OffscreenContext() { library_->destroy(context_); }

void OffscreenContext::make_current() {
  [[maybe_unused]] const ForgiveLeaks forgive;
  if (!library_->make_current(context_, window_.data()))
    throw std::runtime_error(fmt::format(
        "cannot draw: the installed {} cannot activate its OpenGL context: install a newer version of Mesa",
        library_->name()));
}

void OffscreenContext::release() { library_->make_current(nullptr, nullptr); }

OffscreenContext::Procedure OffscreenContext::procedure(const char* name) const {
  const auto found = library_->procedure(name);
  if (!found)
    throw std::runtime_error(fmt::format(
        "cannot draw: the installed {} has no OpenGL function {}: install a newer version of Mesa",
        library_->name(), name));
  return found;
}

}  // namespace troupe::render
