#include "base/math.hpp"

#include "python/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace troupe::python {
namespace {

py::tuple sincos_of(const Numbers& angles) {
  const std::vector<py::ssize_t> shape(angles.shape(), angles.shape() + angles.ndim());
  py::array_t<double> sines(shape);
  py::array_t<double> cosines(shape);
  const std::span<const double> in(angles.data(), static_cast<std::size_t>(angles.size()));
  std::vector<SinCos> both(in.size());
  troupe::sincos(in, both);
  double* sine = sines.mutable_data();
  double* cosine = cosines.mutable_data();
  for (const SinCos& one : both) {
    *sine++ = one.sin;
    *cosine++ = one.cos;
  }
  return py::make_tuple(sines, cosines);
}

/// Returns the sums over the last axis of an array, added in ascending order of the index. The array has an
/// axis: ordered_sum() of python/troupe/math.py raises an error for a single number.
py::array_t<double> ordered_sum(const Numbers& values) {
  const std::vector<py::ssize_t> shape(values.shape(), values.shape() + values.ndim() - 1);
  py::array_t<double> sums(shape);
  sum_rows({values.data(), static_cast<std::size_t>(values.size())},
           static_cast<std::size_t>(values.shape(values.ndim() - 1)),
           {sums.mutable_data(), static_cast<std::size_t>(sums.size())});
  return sums;
}

/// Whether NumPy can broadcast two arrays: in each axis, counted from the last one, their sizes are equal or
/// one of them is 1.
bool can_broadcast(const py::array& a, const py::array& b) {
  for (py::ssize_t i = 1; i <= std::min(a.ndim(), b.ndim()); ++i) {
    const py::ssize_t one = a.shape(a.ndim() - i);
    const py::ssize_t other = b.shape(b.ndim() - i);
    if (one != other && one != 1 && other != 1) return false;
  }
  return true;
}

py::object atan2_of(const py::array_t<double, py::array::forcecast>& y,
                    const py::array_t<double, py::array::forcecast>& x) {
  if (!can_broadcast(y, x))  // else pybind11 raises a RuntimeError that names neither shape
    throw py::value_error(
        fmt::format("atan2(): y has the shape {}, x has the shape {}: give arrays of one shape, or "
                    "arrays that NumPy can broadcast",
                    std::string(py::str(y.attr("shape"))), std::string(py::str(x.attr("shape")))));
  return py::vectorize([](double b, double a) { return troupe::atan2(b, a); })(y, x);
}

}  // namespace

void bind_math(py::module_& module) {
  // NumPy would convert None to NaN, hence none(false).
  module.def("sin", py::vectorize([](double x) { return troupe::sin(x); }), py::arg("radians").none(false),
             "Returns the sine of an angle in radians; NaN for an infinite angle.");
  module.def("cos", py::vectorize([](double x) { return troupe::cos(x); }), py::arg("radians").none(false),
             "Returns the cosine of an angle in radians; NaN for an infinite angle.");
  module.def("sincos", &sincos_of, py::arg("radians").none(false));
  module.def("atan2", &atan2_of, py::arg("y").none(false), py::arg("x").none(false),
             "Returns the direction of the vector (x, y), from -pi to pi. Note the order of the arguments.");
  module.def("exp", py::vectorize([](double x) { return troupe::exp(x); }), py::arg("x").none(false),
             "Returns e to the power of x; inf where the result is too large for a float64.");
  module.def("log", py::vectorize([](double x) { return troupe::log(x); }), py::arg("x").none(false),
             "Returns the natural logarithm of x; -inf for 0, and NaN for negative numbers.");
  module.def("sqrt", py::vectorize([](double x) { return troupe::sqrt(x); }), py::arg("x").none(false),
             "Returns the square root of x; NaN for negative numbers.");
  module.def(
      "wrap_angle", py::vectorize([](double x) { return troupe::wrap_angle(x); }),
      py::arg("radians").none(false),
      "Returns an angle in radians plus the multiple of 2 pi that brings it into the interval from -pi to "
      "pi. Both ends\nbelong to the interval: an angle in it is not changed. NaN for an infinite angle.");
  module.def("ordered_sum", &ordered_sum, py::arg("values").none(false));
}

}  // namespace troupe::python
