// A library for LD_PRELOAD, used by scripts/prove. It changes the process as a careless plug-in or caller
// may do. It is linked with -ffast-math, so that gcc's start-up code disables denormal numbers in the
// loading thread; it sets rounding to upwards; and it sets a global locale with decimal commas.
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
