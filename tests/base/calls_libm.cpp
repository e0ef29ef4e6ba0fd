// What the test of the libraries' symbols must find.
#include <cmath>

double calls_libm(double x) { return std::atan2(std::sin(x), x); }
