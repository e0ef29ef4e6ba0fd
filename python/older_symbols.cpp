// Compiled only into the Python module of a wheel (-DTROUPE_WHEEL=ON). A wheel must run with glibc 2.34 and
// the libstdc++ of gcc 11, but is compiled where both are newer, and a linker takes the newest version of
// each symbol. The linker option --wrap (python/CMakeLists.txt) replaces calls of the symbol that would be
// too new by calls of the function below, which calls an older version. The alternative, compiling on an
// older system, would need its compiler and all libraries there.
#ifdef __x86_64__

// std::condition_variable::wait before gcc 12, which is noexcept.
__asm__(".symver older_wait, _ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE@GLIBCXX_3.4.11");

void older_wait(void* condition, void* lock) __asm__("older_wait");

// The name that --wrap calls.
void wait_of_wheel(void* condition,
                   void* lock) __asm__("__wrap__ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE");

void wait_of_wheel(void* condition, void* lock) { older_wait(condition, lock); }

#endif
