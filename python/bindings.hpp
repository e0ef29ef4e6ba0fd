#pragma once

#include "troupe/troupe.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

/// The module `troupe._core`: the C++ API as Python sees it. What is more comfortable in Python than in C++
/// is written in Python, in python/troupe.
namespace troupe::python {

namespace py = pybind11;

/// Releases the interpreter's lock for as long as it lives. Once the interpreter exits, a daemon thread stops
/// in the constructor or the destructor and stays there until the process ends.
///
/// Python 3.13 and before end a daemon thread that wants the lock by then with pthread_exit(), which unwinds
/// its stack: the destructor of pybind11's gil_scoped_release aborts the process then, and any other frame
/// would give Python's objects back without the lock. A thread that has not asked for the lock yet would
/// still step or load a world while the process destroys its static objects: the exit waits until it has
/// finished that tick, or that world.
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// function(argument), for a function that a program gave. A daemon thread that the interpreter ends in it
/// stops there for good, as in Unlocked.
py::object call(py::handle function, py::handle argument);

/// A simulation as Python holds it: what Python reads of it keeps it alive.
///
/// Steps are taken without the interpreter's lock, so that other threads of Python run meanwhile. A
/// simulation is not for several threads: one that is stepping refuses every call with a RuntimeError.
class Held {
 public:
  explicit Held(Simulation&& simulation) : simulation_(std::move(simulation)) {}

  /// The simulation, for a call that comes with the interpreter's lock. Throws std::logic_error while it
  /// steps.
  Simulation& use();
  /// Ticks, one after another; signals are looked at now and then, so that Ctrl-C ends it between two of
  /// them. `to_its_end`: none where the run is over.
  void step(std::uint64_t ticks, bool to_its_end = false);
  /// The simulation, for what is not to be done in a callback of on_tick(): throws std::logic_error there.
  Simulation& use_outside(std::string_view what);
  /// While it lives, callbacks of on_tick() are called.
  class Calling {
   public:
    explicit Calling(Held& held) : calling_(held.calling_) { calling_ = true; }
    ~Calling() { calling_ = false; }
    Calling(const Calling&) = delete;
    Calling& operator=(const Calling&) = delete;

   private:
    bool& calling_;
  };

 private:
  Simulation simulation_;
  bool calling_ = false;
  bool stepping_ = false;  // under the interpreter's lock
};
using Holder = std::shared_ptr<Held>;
using SimulationClass = py::class_<Held, Holder>;

/// A model with the simulation that it is of.
struct HeldModel {
  Holder held;
  Model model;

  Model& use() {
    static_cast<void>(held->use());
    return model;
  }
};

/// An array that shows memory of the simulation without copying it: read-only, and alive as long as it is.
py::array view(const py::dtype& type, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               const void* first, const Holder& owner);

template <class T>
py::array view(std::span<const T> values, const Holder& owner) {
  return view(py::dtype::of<T>(), {static_cast<py::ssize_t>(values.size())}, {sizeof(T)}, values.data(),
              owner);
}

/// The elements of an array that is contiguous, to be filled.
template <class T, class Element>
std::span<T> elements(py::array_t<Element>& array) {
  return {reinterpret_cast<T*>(array.mutable_data()), static_cast<std::size_t>(array.nbytes()) / sizeof(T)};
}

/// What NumPy calls the elements of a field.
py::dtype dtype_of(engine::Element element);

/// Has the exit of the interpreter wait for other threads: see Unlocked.
void bind_exit();
void bind_errors(py::module_& module);
py::dict dict_of(const Model::Energy& energy);
void bind_models(py::module_& module);
SimulationClass bind_simulation(py::module_& module);
void bind_swarm(py::module_& module, SimulationClass& simulation);
void bind_tables(py::module_& module, SimulationClass& simulation);
void bind_observers(py::module_& module);
void bind_batch(py::module_& module);
void bind_math(py::module_& module);
void bind_study(py::module_& module);

}  // namespace troupe::python
