// A library for LD_PRELOAD, with which a program finds other libraries for pictures than those of this
// machine: no OSMesa and, if the environment variable FAKE_GPU is set, a graphics card as the first device of
// EGL. If FAKE_GPU is "only", EGL has no other device. The program ends if it opens the display of this card.

#include <dlfcn.h>

#include <cstdlib>
#include <cstring>

namespace {

using Function = void (*)();
using Open = void* (*)(const char* file, int flags);

template <class Type>
Type symbol(void* library, const char* name) {
  return reinterpret_cast<Type>(dlsym(library, name));
}

int fake_gpu = 0;  // its address is the device

Function real(const char* name) {
  static void* const egl = symbol<Open>(RTLD_NEXT, "dlopen")("libEGL.so.1", RTLD_NOW);
  return symbol<Function (*)(const char*)>(egl, "eglGetProcAddress")(name);
}

unsigned query_devices(int most, void** devices, int* count) {
  devices[0] = &fake_gpu;
  *count = 0;
  if (std::strcmp(std::getenv("FAKE_GPU"), "only") != 0)
    reinterpret_cast<unsigned (*)(int, void**, int*)>(real("eglQueryDevicesEXT"))(most - 1, devices + 1,
                                                                                  count);
  ++*count;
  return 1;
}

const char* query_device(void* device, int name) {
  if (device == &fake_gpu) return "EGL_EXT_device_drm EGL_NV_device_cuda";
  return reinterpret_cast<const char* (*)(void*, int)>(real("eglQueryDeviceStringEXT"))(device, name);
}

void* get_display(unsigned platform, void* device, const int* attributes) {
  if (device == &fake_gpu) std::abort();
  return reinterpret_cast<void* (*)(unsigned, void*, const int*)>(real("eglGetPlatformDisplayEXT"))(
      platform, device, attributes);
}

}  // namespace

extern "C" Function eglGetProcAddress(const char* name) {
  if (std::strcmp(name, "eglQueryDevicesEXT") == 0) return reinterpret_cast<Function>(query_devices);
  if (std::strcmp(name, "eglQueryDeviceStringEXT") == 0) return reinterpret_cast<Function>(query_device);
  if (std::strcmp(name, "eglGetPlatformDisplayEXT") == 0) return reinterpret_cast<Function>(get_display);
  return real(name);
}

extern "C" void* dlopen(const char* file, int flags) {
  const auto open = symbol<Open>(RTLD_NEXT, "dlopen");
  if (file && std::strstr(file, "libOSMesa")) return open("libOSMesa-is-hidden.so", flags);
  if (file && std::strcmp(file, "libEGL.so.1") == 0 && std::getenv("FAKE_GPU")) {
    Dl_info own{};
    dladdr(&fake_gpu, &own);
    return open(own.dli_fname, flags);
  }
  return open(file, flags);
}
