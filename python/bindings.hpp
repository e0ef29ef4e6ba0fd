#pragma once

#include "troupe/script.hpp"
#include "troupe/troupe.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// The Python module `troupe._core`, which makes the C++ API available in Python. Functions that need no C++
/// are written in Python, in python/troupe.
namespace troupe::python {

namespace py = pybind11;

/// Releases the interpreter's lock (GIL) while an object of this class exists. The calling thread must hold
/// the lock when it creates the object.
///
/// After the interpreter has begun to exit, a daemon thread never gets the lock back: it blocks in the
/// constructor or the destructor until the process ends. (Python waits for all other threads before it
/// exits.) If the daemon thread requested the lock instead, Python 3.13 and earlier would call
/// pthread_exit(), which unwinds the stack of the thread. Destructors on the stack would then abort the
/// process, or release Python objects without the lock.
///
/// The exit of the interpreter waits until each thread that has released the lock with this class reaches the
/// destructor (see bind_exit()). Otherwise a thread could step or load a world while the process destroys its
/// static objects.
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// Whether the calling thread is the main thread of the process, on which Python handles signals.
bool is_main_thread();

/// Returns whether Ctrl-C was pressed or the interpreter has begun to exit. The caller need not hold the
/// interpreter's lock. Only a call on the main thread notices Ctrl-C. The signal stays pending, so Python
/// raises KeyboardInterrupt later.
bool is_interrupted();

/// While an object of this class exists on the main thread, Ctrl-C does not raise KeyboardInterrupt in Python
/// code, such as decide() of a controller. Otherwise the exception would end the tick, and with it the run.
/// If Ctrl-C was pressed meanwhile, it is pending after the destructor: Python raises KeyboardInterrupt
/// later, or calls the signal handler of the program. A second Ctrl-C raises it at once, so that it ends a
/// function that does not return. Objects on other threads have no effect, because Python handles signals on
/// the main thread only. If a program ignores the signal, or lets it end the process, this does not change.
class InterruptDelay {
 public:
  InterruptDelay();
  ~InterruptDelay();
  InterruptDelay(const InterruptDelay&) = delete;
  InterruptDelay& operator=(const InterruptDelay&) = delete;

 private:
  bool delays_;
};

/// Calls the Python function `function` with one argument and returns its result. The caller must hold the
/// interpreter's lock. Throws py::error_already_set if the function raises an exception, and py::type_error
/// if it is a generator function or an async function, because the call then executes no statement of it. If
/// the interpreter exits during the call, a daemon thread blocks in this function until the process ends, for
/// the reason that Unlocked explains.
py::object call(py::handle function, py::handle argument);

/// Calls `function`, a measure in Python, with the robots for which it is computed, and returns its result.
/// The function can use its argument only during the call. The caller must hold the interpreter's lock.
/// Throws as call() does, and py::error_already_set if the result is not a number (ResultError of
/// troupe/_script.py).
double measured(const py::object& function, Swarm robots);

/// Returns the unit that a measure in Python declares; Unit::none for an empty text. troupe/_script.py has
/// checked that other texts are known.
engine::Unit unit_of(const std::string& symbol);

/// A simulation owned by Python. Arrays and handles that refer to it keep it alive.
///
/// It steps and draws without the interpreter's lock, so that other Python threads can run meanwhile. Only
/// one thread at a time may use a simulation: meanwhile, calls of other threads raise RuntimeError. All
/// functions must be called with the interpreter's lock, except use_while_stepping().
class Held {
 public:
  explicit Held(Simulation&& simulation) : simulation_(std::move(simulation)) {}

  /// Returns the simulation. Throws std::logic_error while step() or work() runs.
  Simulation& use();
  /// Makes `ticks` ticks (time steps) without the interpreter's lock. to_its_end: if true, the function
  /// returns earlier if a stop condition of the world ends the run. Ctrl-C raises KeyboardInterrupt between
  /// two ticks. Throws as use() does, and if a tick fails.
  void step(std::uint64_t ticks, bool to_its_end = false);
  /// Calls `task` without the interpreter's lock. Until `task` returns, use() throws, as during step(). If
  /// Ctrl-C was pressed meanwhile, raises KeyboardInterrupt afterwards. Throws as use() does.
  void work(const std::function<void(Simulation&)>& task);
  /// Returns the simulation without a check, for code that step() or work() calls. In such code, use() would
  /// throw.
  const Simulation& use_while_stepping() const { return simulation_; }
  /// Keeps `view`, a live view of the simulation, alive during each later call of step() or work(). Otherwise
  /// another thread could destroy the view while the step waits in it. The view is not kept alive between two
  /// calls. A second call replaces the view.
  void keep_while_stepping(std::weak_ptr<void> view) { view_ = std::move(view); }
  /// Returns the simulation, as use() does, but also throws std::logic_error if a callback is running (see
  /// Calling). This is for functions that callbacks must not call, such as step() and reset() in Python.
  /// what: name of the function, for the text of the error.
  Simulation& use_outside(std::string_view what);
  /// Marks that a Python callback of on_tick(), run_for() or run_until() is running, while an object of this
  /// class exists. Meanwhile use() does not throw, also if work() has called the callback. The destructor
  /// waits until no other thread runs work(), which may have begun during the callback.
  class Calling {
   public:
    explicit Calling(Held& held) : held_(held), was_stepping_(std::exchange(held.stepping_, false)) {
      held_.calling_ = true;
    }
    ~Calling() {
      held_.wait_for_others();
      held_.calling_ = false;
      held_.stepping_ = was_stepping_;
    }
    Calling(const Calling&) = delete;
    Calling& operator=(const Calling&) = delete;

   private:
    Held& held_;
    bool was_stepping_;
  };

 private:
  class Stepping;
  void wait_for_others();

  Simulation simulation_;
  bool calling_ = false;
  bool stepping_ = false;  // read and written only with the interpreter's lock
  bool waiting_ = false;   // a thread waits for the end of the task of another one
  std::weak_ptr<void> view_;
};
using Holder = std::shared_ptr<Held>;

/// Returns the list of callbacks of Simulation.on_tick() in Python. simulation: the Python object.
py::list callbacks_of(const py::object& simulation);

/// Checks a parameter that is a length or a time, and returns `value` unchanged. The value 0 stands for the
/// default and is allowed. Throws std::invalid_argument if the value is negative, NaN or above `most`. what:
/// name and unit of the parameter for the text of the error, as in "every_s (s)".
double from_zero(std::string_view what, double value, double most);

/// Returns the JSON text of a Python value (troupe/_json.py), which may contain NumPy numbers and arrays.
/// Throws py::error_already_set if the value, such as NaN, has none.
/// indent: the parameter of json.dumps().
std::string json_of(const py::object& value, const py::object& indent = py::none());

/// Returns the text of a Python value for the text of an error: that of repr(), shortened if it is long.
std::string short_repr(const py::handle& value);

/// Returns a text that may contain the name of a file, which need not be UTF-8, as os.fsdecode() returns it
/// for UTF-8.
py::str decoded(std::string_view text);

/// Two numbers, or None.
using Two = std::optional<std::array<double, 2>>;
/// Returns the options of a picture, made from the arguments of Simulation.picture() in Python. Throws
/// std::invalid_argument if the width or the height is below 1; checks no other argument.
PictureOptions picture_options(int width, int height, const std::string& camera, const std::string& layers,
                               const Two& center_m, const Two& angle_rad,
                               const std::optional<double>& across_m, const std::string& color_by,
                               const Two& color_range, const std::string& background);
/// Returns a function for Python with arguments of the types `First`, followed by those of picture_options().
/// It calls draw() with the first arguments and the options of the picture.
template <class... First, class Draw>
auto drawing(Draw draw) {
  return [draw](First... first, int width, int height, const std::string& camera, const std::string& layers,
                const Two& center_m, const Two& angle_rad, const std::optional<double>& across_m,
                const std::string& color_by, const Two& color_range, const std::string& background) {
    return draw(first..., picture_options(width, height, camera, layers, center_m, angle_rad, across_m,
                                          color_by, color_range, background));
  };
}
/// Calls define() with what declares the arguments of drawing() after `width` and `height`, for def().
template <class Define>
void with_look(Define&& define) {
  define(py::kw_only(), py::arg("camera") = "top", py::arg("layers") = "", py::arg("center_m") = py::none(),
         py::arg("angle_rad") = py::none(), py::arg("across_m") = py::none(), py::arg("color_by") = "",
         py::arg("color_range") = py::none(), py::arg("background") = "paper");
}
/// Returns a picture as an array with the shape (height, width, 3). rgb: three bytes per pixel, row by row.
py::array_t<std::uint8_t> picture_array(std::span<const std::uint8_t> rgb, const PictureOptions& options);

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

/// A swarm (a group of robots of a simulation) owned by Python. It keeps its simulation alive, if `held` is
/// not null.
struct HeldSwarm {
  Holder held;  ///< the simulation; null for the swarm that is the argument of a measure written in Python
  Swarm swarm;
  bool is_over = false;  ///< the measure has returned: its simulation may no longer exist

  /// Returns the swarm. Throws as Held::use() does if `held` is not null, and as read() does.
  Swarm& use() {
    if (held) static_cast<void>(held->use());
    read();
    return swarm;
  }
  /// Returns the swarm, also while the simulation steps. Throws std::logic_error if `is_over` is true.
  const Swarm& read() const {
    if (is_over)
      throw std::logic_error(
          "the argument of a measure can be used only during the call of the measure: in other code, use "
          "Simulation.swarm()");
    return swarm;
  }
  py::ssize_t size() const { return static_cast<py::ssize_t>(swarm.size()); }
};

/// Returns a read-only NumPy array that refers to the memory of a simulation. The array keeps the simulation
/// (`owner`) alive. first: address of the first element. strides: for each axis, the distance from one
/// element to the next, bytes.
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

/// A list of folders, or one folder.
using Paths = std::variant<std::vector<std::filesystem::path>, std::filesystem::path>;
std::vector<std::filesystem::path> folders_of(Paths paths);

/// Loads Python scripts (python/troupe/_script.py), which define controllers and measures. A controller is a
/// class that decides what robots do; a measure is a function that computes a number from the state.
/// `sources` is the file name of a script, a class derived from troupe.Controller, or a list of these.
///
/// Throws py::error_already_set if a source cannot be loaded. It contains the Python exception InputError
/// for an invalid script, and TypeError for a source of another type.
std::vector<std::shared_ptr<const Script>> scripts_of(const py::object& sources);

/// Returns the text of a Python exception, with the line of the script in which it was raised.
std::string error_text(const py::error_already_set& error, const std::string& file);

/// Returns the NumPy type for an element type of the state of a simulation, such as float64 for Element::f64.
py::dtype dtype_of(engine::Element element);

/// Makes the exit of the interpreter wait for threads that have released its lock. Unlocked explains why.
void bind_exit();
/// Adds the exceptions of the module and maps C++ exceptions to Python exceptions.
void bind_errors(py::module_& module);
/// Converts the energies of a power pack (the energy store of a body) to a dict. `energy` may also be the sum
/// of the energies of several packs. The keys are the names of the members of Model::Energy. The values are
/// energies in J, and bools for `infinite` and `charging`.
py::dict dict_of(const Model::Energy& energy);

// Each of the following functions adds classes and functions to the module.
void bind_models(py::module_& module);
SimulationClass bind_simulation(py::module_& module);
void bind_loading(SimulationClass& simulation);
void bind_swarm(py::module_& module, SimulationClass& simulation);
void bind_tables(py::module_& module, SimulationClass& simulation);
void bind_observers(py::module_& module);
void bind_batch(py::module_& module);
void bind_live(py::module_& module, SimulationClass& simulation);
void bind_math(py::module_& module);
void bind_study(py::module_& module);
void bind_robot_batch(py::module_& module);
void bind_program(py::module_& module);
void bind_scripts(py::module_& module);
/// Gives all functions and methods of the module clear messages for arguments that do not fit
/// (python/troupe/_arguments.py), in place of pybind11's lists of C++ signatures. Call it last.
void explain_arguments(py::module_& module);

}  // namespace troupe::python
