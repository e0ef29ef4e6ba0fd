// Calls of libm that the test base.FindsCallsOfLibm must find.
#include <cmath>

double calls_libm(double x) { return std::atan2(std::sin(x), x); }
