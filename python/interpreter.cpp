// The lock and the exit of the Python interpreter, and its handling of Ctrl-C.

#include "python/bindings.hpp"

#include <cxxabi.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <csignal>

namespace troupe::python {
namespace {

// State of Unlocked and of the exit of the interpreter.
std::atomic<int> at_work = 0;  // threads that have released the lock and not taken it back
std::atomic<bool> is_ending = false;
pthread_t ending_thread;  // the thread that ends the interpreter

// State of InterruptDelay.
bool is_delaying = false;         // an object that delays Ctrl-C exists; used only on the main thread
struct sigaction undelayed = {};  // what a signal would have done without this object
std::atomic<bool> is_delayed = false;

extern "C" void delay_interrupt(int signal) {
  if (!is_delayed.exchange(true)) return;
  is_delayed = false;  // the second signal stands for both
  undelayed.sa_handler(signal);
}

bool must_stop() { return is_ending && pthread_equal(pthread_self(), ending_thread) == 0; }

[[noreturn]] void stop_for_good() {
  for (;;) pause();
}

}  // namespace

Unlocked::Unlocked() {
  if (must_stop()) {
    PyEval_SaveThread();
    stop_for_good();
  }
  ++at_work;  // the lock is still held, so the exit cannot miss this thread
  state_ = PyEval_SaveThread();
}

Unlocked::~Unlocked() {
  --at_work;
  at_work.notify_all();
  if (must_stop()) stop_for_good();
#ifdef __GLIBCXX__
  try {
    PyEval_RestoreThread(state_);
  } catch (const abi::__forced_unwind&) {
    stop_for_good();  // a handler that returned would continue the unwinding
  }
#else
  PyEval_RestoreThread(state_);
#endif
}

bool is_main_thread() { return gettid() == getpid(); }

bool is_interrupted() {
  if (must_stop()) return true;
  if (!is_main_thread()) return false;  // Python handles signals in the main thread only
  if (is_delayed) return true;
  const py::gil_scoped_acquire lock;
  if (PyOS_InterruptOccurred() == 0) return false;
  PyErr_SetInterrupt();
  return true;
}

InterruptDelay::InterruptDelay() : delays_(is_main_thread() && !is_delaying) {
  if (!delays_) return;
  sigaction(SIGINT, nullptr, &undelayed);
  const bool has_handler = undelayed.sa_handler != SIG_DFL && undelayed.sa_handler != SIG_IGN;
  delays_ = has_handler && (undelayed.sa_flags & SA_SIGINFO) == 0;
  if (!delays_) return;
  is_delaying = true;
  struct sigaction own = undelayed;
  own.sa_handler = &delay_interrupt;
  sigaction(SIGINT, &own, nullptr);
}

InterruptDelay::~InterruptDelay() {
  if (!delays_) return;
  sigaction(SIGINT, &undelayed, nullptr);
  is_delaying = false;
  if (is_delayed.exchange(false)) PyErr_SetInterrupt();
}

py::object call(py::handle function, py::handle argument) {
  PyObject* result = nullptr;
#ifdef __GLIBCXX__
  try {  // contains only this call, because no frame of this module may be unwound
    result = PyObject_CallFunctionObjArgs(function.ptr(), argument.ptr(), nullptr);
  } catch (const abi::__forced_unwind&) {
    stop_for_good();
  }
#else
  result = PyObject_CallFunctionObjArgs(function.ptr(), argument.ptr(), nullptr);
#endif
  if (result == nullptr) throw py::error_already_set();
  auto owned = py::reinterpret_steal<py::object>(result);
  const bool is_generator = PyGen_Check(result) || PyAsyncGen_CheckExact(result);
  if (is_generator || PyCoro_CheckExact(result)) {
    if (PyCoro_CheckExact(result)) owned.attr("close")();  // else Python warns that it was never awaited
    PyErr_Format(PyExc_TypeError,
                 "%R is %s function, so that a call executes none of its statements: write it without `%s`",
                 function.ptr(), is_generator ? "a generator" : "an async", is_generator ? "yield" : "async");
    throw py::error_already_set();
  }
  return owned;
}

void bind_exit() {
  // After fork() the child has only the thread that called it, which holds the lock: no thread is at work.
  pthread_atfork(nullptr, nullptr, [] { at_work = 0; });
  const auto begin_exit = [] {
    ending_thread = pthread_self();
    is_ending = true;
    PyThreadState* const state = PyEval_SaveThread();
    for (int others; (others = at_work) > 0;) at_work.wait(others);
    PyEval_RestoreThread(state);
  };
  py::module_::import("atexit").attr("register")(py::cpp_function(begin_exit));
}

}  // namespace troupe::python
