// Compiled only into the Python module of a wheel (-DTROUPE_WHEEL=ON). A wheel must run with glibc 2.34 and
// the libstdc++ of gcc 11, but is compiled where both are newer, and a linker takes the newest version of
// each symbol. The linker option --wrap (python/CMakeLists.txt) replaces calls of the two symbols that would
// be too new by calls of the functions below, which call an older version. The alternative, compiling on an
// older system, would need its compiler and all libraries there.
#ifdef __x86_64__

// The version before glibc 2.35, which also sets errno. Only SVG and PDF pictures use the function.
__asm__(".symver older_hypotf, hypotf@GLIBC_2.2.5");
// std::condition_variable::wait before gcc 12, which is noexcept.
__asm__(".symver older_wait, _ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE@GLIBCXX_3.4.11");

float older_hypotf(float x, float y) __asm__("older_hypotf");
void older_wait(void* condition, void* lock) __asm__("older_wait");

// The names that --wrap calls.
float hypotf_of_wheel(float x, float y) __asm__("__wrap_hypotf");
void wait_of_wheel(void* condition,
                   void* lock) __asm__("__wrap__ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE");

float hypotf_of_wheel(float x, float y) { return older_hypotf(x, y); }

void wait_of_wheel(void* condition, void* lock) { older_wait(condition, lock); }

#endif
