#pragma once

#include "troupe/script.hpp"
#include "troupe/troupe.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

/// The Python module `troupe._core`, which makes the C++ API available in Python. Functions that need no C++
/// are written in Python, in python/troupe.
namespace troupe::python {

namespace py = pybind11;

/// Releases the interpreter's lock (GIL) while an object of this class exists. After the interpreter has
/// begun to exit, threads other than the exiting one block in the constructor or the destructor until the
/// process ends. These are daemon threads, because Python waits for threads of other kinds before it exits.
///
/// Python 3.13 and earlier call pthread_exit() in a daemon thread that requests the lock after the exit has
/// begun. This unwinds the stack of the thread: the destructor of pybind11's gil_scoped_release then aborts
/// the process, and other destructors would release Python objects without the lock. A thread that has not
/// requested the lock yet would step or load a world while the process destroys its static objects. The exit
/// therefore waits until the thread has finished its tick or loaded its world.
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// Whether Ctrl-C was pressed or the interpreter exits, for code that waits without the interpreter's lock.
/// Only calls on the main thread notice Ctrl-C. The signal stays pending, so that Python raises
/// KeyboardInterrupt later.
bool is_interrupted();

/// Calls the Python function `function` with one argument. If the interpreter exits during the call and the
/// caller is a daemon thread, this function blocks until the process ends. Unlocked explains why.
py::object call(py::handle function, py::handle argument);

/// A simulation owned by Python. Arrays and handles that refer to it keep it alive.
///
/// It steps without the interpreter's lock, so that other Python threads can run meanwhile. Only one thread
/// at a time may use a simulation: calls of other threads during a step raise RuntimeError.
class Held {
 public:
  explicit Held(Simulation&& simulation) : simulation_(std::move(simulation)) {}

  /// Returns the simulation. The caller must hold the interpreter's lock. Throws std::logic_error while
  /// another thread steps the simulation.
  Simulation& use();
  /// Makes `ticks` ticks (simulation steps). Checks for signals regularly, so that Ctrl-C ends the run
  /// between two ticks. to_its_end: whether to stop early if a stop condition of the world ends the run.
  void step(std::uint64_t ticks, bool to_its_end = false);
  /// Calls `task` without the interpreter's lock. Until it returns, use() throws, as during a step. Raises
  /// KeyboardInterrupt afterwards if Ctrl-C was pressed.
  void work(const std::function<void(Simulation&)>& task);
  /// The simulation, for code that runs during a step, in which use() throws.
  const Simulation& use_while_stepping() const { return simulation_; }
  /// Returns the simulation as use() does, for functions that a callback of on_tick(), run_for() or
  /// run_until() must not call. Throws std::logic_error in such a callback. what: name of the function, for
  /// the error text.
  Simulation& use_outside(std::string_view what);
  /// While an object of this class exists, a callback is running, and use_outside() throws.
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
  class Stepping;

  Simulation simulation_;
  bool calling_ = false;
  bool stepping_ = false;  // read and written only with the interpreter's lock
};
using Holder = std::shared_ptr<Held>;

/// Returns `value`, a parameter that is a length or a time, where 0 selects the default. Throws
/// std::invalid_argument if the value is negative, NaN or above `most`. what: the parameter and its unit, as
/// in "every_s (s)".
double from_zero(std::string_view what, double value, double most);

/// Two numbers, or None.
using Two = std::optional<std::array<double, 2>>;
/// Returns the options of a picture from the arguments of Simulation.picture(). Throws std::invalid_argument
/// for a width or height below 1.
PictureOptions picture_options(int width, int height, const std::string& camera, const std::string& layers,
                               const Two& center_m, const Two& angle_rad,
                               const std::optional<double>& across_m, const std::string& color_by,
                               const Two& color_range, const std::string& background);

using SimulationClass = py::class_<Held, Holder>;

/// A model (a body of the simulated world, or a part of a body) owned by Python. It keeps its simulation
/// alive.
struct HeldModel {
  Holder held;
  Model model;

  /// Returns the model. Throws as Held::use() does.
  Model& use() {
    static_cast<void>(held->use());
    return model;
  }
};

/// A swarm (a group of robots of a simulation) owned by Python. It keeps its simulation alive.
struct HeldSwarm {
  Holder held;  ///< null for a swarm that a Python function for a measure gets as its argument
  Swarm swarm;

  /// Returns the swarm. Throws as Held::use() does.
  Swarm& use() {
    if (held) static_cast<void>(held->use());
    return swarm;
  }
  py::ssize_t size() const { return static_cast<py::ssize_t>(swarm.size()); }
};

/// Returns a read-only NumPy array that refers to the memory of a simulation. The array keeps the simulation
/// (`owner`) alive. first: address of the first element. strides: distance of neighbouring elements along
/// each axis, bytes.
py::array view(const py::dtype& type, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               const void* first, const Holder& owner);

template <class T>
py::array view(std::span<const T> values, const Holder& owner) {
  return view(py::dtype::of<T>(), {static_cast<py::ssize_t>(values.size())}, {sizeof(T)}, values.data(),
              owner);
}

/// Returns the memory of a contiguous array as a writable span of T, valid while the array exists. T must
/// consist of one or more numbers of the type Element, as Pose consists of four doubles.
template <class T, class Element>
std::span<T> elements(py::array_t<Element>& array) {
  return {reinterpret_cast<T*>(array.mutable_data()), static_cast<std::size_t>(array.nbytes()) / sizeof(T)};
}

/// Loads the controllers (functions that decide what the robots do) and measures (numbers computed from the
/// state) of Python scripts (python/troupe/_script.py). sources: a list whose elements are names of scripts
/// or classes of controllers. Throws InputError for an invalid script or class.
std::vector<std::shared_ptr<const Script>> scripts_of(const py::list& sources);

/// Returns the NumPy type that corresponds to a C++ element type of the tables in which the engine stores the
/// state.
py::dtype dtype_of(engine::Element element);

/// Makes the exit of the interpreter wait for threads that have released its lock; Unlocked explains why.
void bind_exit();
/// Adds the exceptions of the module and maps C++ exceptions to Python exceptions.
void bind_errors(py::module_& module);
/// Converts the data of power packs (batteries; energies in J, and two bools) to a dict whose keys are the
/// names of the members of Model::Energy.
py::dict dict_of(const Model::Energy& energy);

// Each of the following functions adds classes and functions to the module.
void bind_models(py::module_& module);
SimulationClass bind_simulation(py::module_& module);
void bind_swarm(py::module_& module, SimulationClass& simulation);
void bind_tables(py::module_& module, SimulationClass& simulation);
void bind_observers(py::module_& module);
void bind_batch(py::module_& module);
void bind_live(py::module_& module, SimulationClass& simulation);
void bind_math(py::module_& module);
void bind_study(py::module_& module);
void bind_script(py::module_& module);

}  // namespace troupe::python
