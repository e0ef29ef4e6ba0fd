#include "base/scoped_flag.hpp"
#include "engine/world/world.hpp"
#include "partition/simd_target.hpp"
#include "troupe/version.hpp"
#include "python/bindings.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

namespace troupe::python {
namespace {

/// Makes a Python class of exceptions in the module. The class is never released, because objects of it may
/// outlive the module.
py::handle new_exception(py::module_& module, const char* name, PyObject* base) {
  const py::exception<void> exception(module, name, base);
  return py::object(exception).release();
}

py::handle input_error;
py::handle step_error;

/// Returns the text of an exception. It may quote the name or the content of a file, whose bytes need not be
/// UTF-8.
py::object text_of(const std::exception& error) {
  const std::string_view text = error.what();
  return py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "backslashreplace"));
}

/// Returns the Python exception that caused `error`, which contains it as a std::nested_exception; null if
/// there is none.
py::object cause_of(const std::exception& error) {
  try {
    std::rethrow_if_nested(error);
  } catch (const py::error_already_set& thrown) {
    if (thrown.trace()) PyException_SetTraceback(thrown.value().ptr(), thrown.trace().ptr());
    return thrown.value();
  } catch (const std::exception& nested) {
    return cause_of(nested);
  } catch (...) {  // an exception of a plug-in
  }
  return {};
}

/// Raises a Python exception of the class `type` with the text of `error`. Its __cause__ is the Python
/// exception that caused the error, if any. If that one is not derived from Exception, such as
/// KeyboardInterrupt and SystemExit, it is raised instead: it is no error, but ends the program.
void raise_error(py::handle type, const std::exception& error) {
  py::object cause = cause_of(error);
  const bool ends_program = cause && PyObject_IsInstance(cause.ptr(), PyExc_Exception) == 0;
  const py::object raised = ends_program ? cause : type(text_of(error));
  if (cause && !ends_program) PyException_SetCause(raised.ptr(), cause.release().ptr());
  PyErr_SetObject(py::type::handle_of(raised).ptr(), raised.ptr());
}

/// Selects the instruction set for range finding that the environment variable TROUPE_SIMD names. Does
/// nothing if the variable is not set or empty. Throws ImportError if the instruction set cannot be used.
void obey_simd_variable() {
  const char* name = std::getenv("TROUPE_SIMD");
  if (name == nullptr || *name == '\0') return;
  try {
    partition::use_simd_target(name);
  } catch (const std::invalid_argument& error) {
    throw py::import_error(std::string("TROUPE_SIMD: error: ") + error.what());
  }
}

/// Whether this version of pybind11 works only with NumPy 1. Before version 2.12, pybind11 reads the size of
/// array elements from a place that NumPy 2 has moved. With NumPy 2, all elements of an array would have the
/// value of the first element, without an error.
constexpr bool k_needs_numpy_1 = PYBIND11_VERSION_HEX < 0x020C0000;

/// Throws ImportError for a NumPy that pybind11 cannot read.
void check_numpy() {
  if (!k_needs_numpy_1) return;
  const std::string version = py::str(py::module_::import("numpy").attr("__version__"));
  if (version.starts_with("0.") || version.starts_with("1.")) return;
  throw py::import_error(
      fmt::format("troupe was built with pybind11 {}.{}, which needs NumPy 1, but NumPy {} is installed: pip "
                  "install \"numpy<2\"",
                  PYBIND11_VERSION_MAJOR, PYBIND11_VERSION_MINOR, version));
}

}  // namespace

std::string short_repr(const py::handle& value) {
  return py::str(py::module_::import("reprlib").attr("repr")(value));
}

py::str decoded(std::string_view text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape"));
}

double measured(const py::object& function, Swarm robots) {
  const py::object argument = py::cast(HeldSwarm{nullptr, std::move(robots)});
  struct End {
    const py::object& argument;
    ~End() { argument.cast<HeldSwarm&>().is_over = true; }
  } const end{argument};
  const py::object result = call(function, argument);
  if (py::isinstance<py::float_>(result)) return result.cast<double>();  // without a call into Python
  return py::module_::import("troupe._script").attr("number_of")(function, result).cast<double>();
}

void Held::wait_for_others() {
  constexpr std::chrono::milliseconds k_patience(1);
  const ScopedFlag waiting(waiting_);  // no further task may begin
  while (stepping_) {
    const Unlocked unlocked;
    std::this_thread::sleep_for(k_patience);
  }
}

Simulation& Held::use() {
  if (stepping_ || waiting_)
    throw std::logic_error(
        "this simulation is being used by another thread, or by the step that calls this code: only one "
        "thread at a time may use a simulation, and decide() of a controller may use only its argument");
  return simulation_;
}

Simulation& Held::use_outside(std::string_view what) {
  if (calling_)
    throw std::logic_error(
        fmt::format("{} is not allowed in a callback of on_tick(), run_for() or run_until(): call it outside "
                    "the callback",
                    what));
  return use();
}

/// Sets Held::stepping_ and keeps the live view alive while an object of this class exists. The destructor
/// destroys the view if Python has released it meanwhile.
class Held::Stepping {
 public:
  explicit Stepping(Held& held) : view_(held.view_.lock()), stepping_(held.stepping_) {}

 private:
  std::shared_ptr<void> view_;
  ScopedFlag stepping_;
};

void Held::work(const std::function<void(Simulation&)>& task) {
  Simulation& simulation = use();
  {
    const Stepping stepping(*this);
    const InterruptDelay delay;
    const Unlocked unlocked;
    task(simulation);
  }
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void Held::step(std::uint64_t ticks, bool to_its_end) {
  constexpr std::chrono::milliseconds k_patience(50);
  Simulation& simulation = use();
  const Stepping stepping(*this);
  const auto is_over = [&] { return to_its_end && simulation.stopped().has_value(); };
  while (ticks > 0 && !is_over()) {
    {
      const InterruptDelay delay;
      const Unlocked unlocked;
      const auto begin = std::chrono::steady_clock::now();
      do {
        simulation.step();
        --ticks;
      } while (ticks > 0 && !is_over() && std::chrono::steady_clock::now() - begin < k_patience);
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

py::array view(const py::dtype& type, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               const void* first, const Holder& owner) {
  py::array array(type, std::move(shape), std::move(strides), first, py::cast(owner));
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// Maps C++ exceptions to Python ones. pybind11 maps the others, but accepts only texts in UTF-8.
void bind_errors(py::module_& module) {
  input_error = new_exception(module, "InputError", PyExc_ValueError);
  input_error.attr("__doc__") =
      "Raised for invalid input: a world, a checkpoint or options. `findings` is the list of the errors, "
      "each a text\nsuch as `maze.world:41: error: ...`.";
  const py::cpp_function findings(
      [](const py::object& error) -> py::object { return py::str(error).attr("split")("\n"); });
  input_error.attr("findings") = py::module_::import("builtins").attr("property")(findings);
  step_error = new_exception(module, "StepError", PyExc_RuntimeError);
  step_error.attr("__doc__") =
      "Raised when a step fails: a commanded speed was not finite, or a controller or a device threw an "
      "exception. The\ntext names the tick and the robot. If an exception in Python code was the cause, "
      "`__cause__` is that "
      "exception.\nThe simulation cannot be used until reset().";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const py::error_already_set&) {
      throw;
    } catch (const py::builtin_exception&) {
      throw;
    } catch (const InputError& error) {
      raise_error(input_error, error);
    } catch (const engine::StepError& error) {
      raise_error(step_error, error);
    } catch (const std::out_of_range& error) {
      // For unknown names, for which IndexError, pybind11's choice, would mislead.
      raise_error(PyExc_LookupError, error);
    } catch (const std::invalid_argument& error) {
      raise_error(PyExc_ValueError, error);
    } catch (const std::filesystem::filesystem_error& error) {
      raise_error(PyExc_OSError, error);
    } catch (const std::runtime_error& error) {
      raise_error(PyExc_RuntimeError, error);
    }
  });
}

}  // namespace troupe::python

PYBIND11_MODULE(_core, module) {
  using namespace troupe::python;
  obey_simd_variable();
  check_numpy();
  module.doc() = "The C++ part of the package troupe.";
  module.attr("__version__") = troupe::k_version;
  module.attr("needs_numpy_1") = k_needs_numpy_1;
  module.def("version_line", &troupe::version_line,
             "Returns one line with the version of Troupe, the compiler and its flags, the processor "
             "architecture, and whether\nassertions are on.");
  bind_exit();
  bind_errors(module);
  SimulationClass simulation = bind_simulation(module);
  bind_swarm(module, simulation);
  bind_tables(module, simulation);
  bind_observers(module);
  bind_batch(module);
  bind_robot_batch(module);
  bind_program(module);
  bind_scripts(module);
  bind_live(module, simulation);
  bind_math(module);
  bind_study(module);
  explain_arguments(module);
}
