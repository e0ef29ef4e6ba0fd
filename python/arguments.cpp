#include "python/bindings.hpp"

#include <string>

namespace troupe::python {
namespace {

/// The function of pybind11 through which Python calls every C++ function of the module. It tries the
/// overloads and raises TypeError if the arguments fit none of them.
PyCFunctionWithKeywords call_overloads = nullptr;

/// Replaces the text of the present exception, a TypeError, if it is pybind11's message about arguments that
/// do not fit.
void explain(PyObject* given, PyObject* named) noexcept {
  py::error_already_set error;  // takes the exception
  try {
    const py::str text(error.value());
    if (std::string(text).find("(): incompatible ") == std::string::npos) return error.restore();
    const py::object arguments = named == nullptr ? py::dict() : py::reinterpret_borrow<py::object>(named);
    const py::object message =
        py::module_::import("troupe._arguments").attr("message")(text, py::handle(given), arguments);
    if (message.equal(text))
      return error.restore();  // an error of Python code, or one without an explanation
    PyErr_SetObject(PyExc_TypeError, message.ptr());
  } catch (...) {  // such as a repr() that raises: pybind11's text is kept
    error.restore();
  }
}

/// Takes the place of `call_overloads` in the functions of the module. Wrappers in Python would make every
/// call slower.
PyObject* call_or_explain(PyObject* function, PyObject* given, PyObject* named) {
  PyObject* const result = call_overloads(function, given, named);
  if (result == nullptr && PyErr_ExceptionMatches(PyExc_TypeError) != 0) explain(given, named);
  return result;
}

using AnyFunction = void (*)();

/// Lets a function that pybind11 has made call call_or_explain(). Ignores any other object.
void explain_in(py::handle object) {
  PyObject* function = object.ptr();
  if (PyInstanceMethod_Check(function)) function = PyInstanceMethod_GET_FUNCTION(function);
  if (!PyCFunction_Check(function)) return;
  PyObject* const record = PyCFunction_GET_SELF(function);
  if (record == nullptr || !PyCapsule_CheckExact(record)) return;
  PyMethodDef& definition = *reinterpret_cast<PyCFunctionObject*>(function)->m_ml;
  if (definition.ml_flags != (METH_VARARGS | METH_KEYWORDS)) return;
  const auto call =
      reinterpret_cast<PyCFunctionWithKeywords>(reinterpret_cast<AnyFunction>(definition.ml_meth));
  if (call == call_or_explain) return;
  if (call_overloads == nullptr) call_overloads = call;
  if (call == call_overloads)
    definition.ml_meth = reinterpret_cast<PyCFunction>(reinterpret_cast<AnyFunction>(call_or_explain));
}

}  // namespace

void explain_arguments(py::module_& module) {
  for (const auto& [name, member] : py::dict(module.attr("__dict__"))) {
    if (!PyType_Check(member.ptr())) {
      explain_in(member);
      continue;
    }
    for (const auto& entry : py::dict(member.attr("__dict__"))) {
      const py::handle method = entry.second;
      const auto is_of = [&](PyTypeObject& type) {
        return py::isinstance(method, py::handle(reinterpret_cast<PyObject*>(&type)));
      };
      explain_in(is_of(PyStaticMethod_Type) ? method.attr("__func__")
                 : is_of(PyProperty_Type)   ? method.attr("fset")
                                            : py::reinterpret_borrow<py::object>(method));
    }
  }
}

}  // namespace troupe::python
