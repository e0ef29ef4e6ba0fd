// A library to be preloaded (LD_PRELOAD) by scripts/prove, that does to a program what a careless plug-in or
// caller does: it is linked with -ffast-math, so that gcc's start-up code switches denormal numbers off for
// the loading thread; it rounds upwards; and it makes a locale with decimal commas the global one.
#include <cfenv>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <locale>
#include <string>

namespace {

struct DecimalCommas : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

__attribute__((constructor)) void meddle() {
  // The C library's own: scripts/prove makes it and names it. Without it the proof would prove nothing.
  if (const char* name = std::getenv("TROUPE_LOCALE"); name && !std::setlocale(LC_ALL, name)) {
    std::fprintf(stderr, "surroundings: there is no locale %s\n", name);
    std::_Exit(2);
  }
  std::locale::global(std::locale(std::locale(), new DecimalCommas));
  std::fesetround(FE_UPWARD);
}

}  // namespace
