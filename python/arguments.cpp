#include "python/bindings.hpp"

#include <cstring>
#include <string>
#include <string_view>

namespace troupe::python {
namespace {

using AnyFunction = void (*)();

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

constexpr const char* k_how_to_make =
    "call the class, or the function that returns such objects, in place of __new__()";

/// The name of a class without that of its module.
const char* short_name(const PyTypeObject* type) {
  const char* const dot = std::strrchr(type->tp_name, '.');
  return dot == nullptr ? type->tp_name : dot + 1;
}

/// Whether a class is one of pybind11 or derived from one.
bool is_of_pybind11(py::handle type) {
  return Py_TYPE(type.ptr()) == py::detail::get_internals().default_metaclass;
}

/// Whether an object of a class of pybind11 has no C++ object yet: __new__() was called without the
/// constructor. For such an object, pybind11 would pass memory that is not initialised to the function.
bool is_unmade(PyObject* object) {
  if (!is_of_pybind11(reinterpret_cast<PyObject*>(Py_TYPE(object)))) return false;
  const auto* instance = reinterpret_cast<py::detail::instance*>(object);
  return instance->simple_layout ? instance->simple_value_holder[0] == nullptr
                                 : instance->nonsimple.values_and_holders[0] == nullptr;
}

/// Whether a function makes the C++ object of its first argument.
bool makes_object(PyObject* function) {
  const std::string_view name = reinterpret_cast<PyCFunctionObject*>(function)->m_ml->ml_name;
  return name == "__init__" || name == "__setstate__";
}

/// Returns the first argument that is_unmade(); null if all can be used.
PyObject* find_unmade(PyObject* function, PyObject* given, PyObject* named) {
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(given); ++i) {
    PyObject* const argument = PyTuple_GET_ITEM(given, i);
    if (is_unmade(argument) && (i > 0 || !makes_object(function))) return argument;
  }
  PyObject* key = nullptr;
  PyObject* value = nullptr;
  for (Py_ssize_t at = 0; named != nullptr && PyDict_Next(named, &at, &key, &value) != 0;)
    if (is_unmade(value)) return value;
  return nullptr;
}

/// Takes the place of `call_overloads` in the functions of the module. Wrappers in Python would make every
/// call slower.
PyObject* call_or_explain(PyObject* function, PyObject* given, PyObject* named) {
  if (const PyObject* unmade = find_unmade(function, given, named)) {
    PyErr_Format(PyExc_TypeError, "an object of the class %s was made without its constructor: %s",
                 short_name(Py_TYPE(unmade)), k_how_to_make);
    return nullptr;
  }
  PyObject* const result = call_overloads(function, given, named);
  if (result == nullptr && PyErr_ExceptionMatches(PyExc_TypeError) != 0) explain(given, named);
  return result;
}

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

/// Takes the place of __new__() in a class of the module, which is `owner`. Classes derived from it in Python
/// have to call it.
PyObject* make_derived_only(PyObject* owner, PyObject* given, PyObject* named) {
  auto* const type = reinterpret_cast<PyTypeObject*>(owner);
  PyObject* const wanted = PyTuple_GET_SIZE(given) > 0 ? PyTuple_GET_ITEM(given, 0) : nullptr;
  if (wanted == nullptr || wanted == owner || !PyType_Check(wanted) ||
      PyType_IsSubtype(reinterpret_cast<PyTypeObject*>(wanted), type) == 0) {
    PyErr_Format(PyExc_TypeError, "%s.__new__() makes no object: %s", short_name(type), k_how_to_make);
    return nullptr;
  }
  const auto rest = py::reinterpret_steal<py::object>(PyTuple_GetSlice(given, 1, PyTuple_GET_SIZE(given)));
  return rest ? type->tp_new(reinterpret_cast<PyTypeObject*>(wanted), rest.ptr(), named) : nullptr;
}

/// Lets __new__() of a class fail, so that there are no objects without a C++ object. A call of the class
/// does not use this entry of its dict, but the slot that pybind11 has set. pickle needs __new__() of a class
/// with
/// __setstate__().
void refuse_new(py::handle type) {
  static PyMethodDef definition{
      "__new__", reinterpret_cast<PyCFunction>(reinterpret_cast<AnyFunction>(make_derived_only)),
      METH_VARARGS | METH_KEYWORDS, nullptr};
  auto* const bound = reinterpret_cast<PyTypeObject*>(type.ptr());
  if (PyDict_GetItemString(bound->tp_dict, "__setstate__") != nullptr) return;
  const auto function = py::reinterpret_steal<py::object>(PyCFunction_New(&definition, type.ptr()));
  if (!function || PyDict_SetItemString(bound->tp_dict, "__new__", function.ptr()) != 0)
    throw py::error_already_set();
  PyType_Modified(bound);
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
      if (is_of(PyProperty_Type)) explain_in(method.attr("fget"));
      explain_in(is_of(PyStaticMethod_Type) ? method.attr("__func__")
                 : is_of(PyProperty_Type)   ? method.attr("fset")
                                            : py::reinterpret_borrow<py::object>(method));
    }
    if (is_of_pybind11(member)) refuse_new(member);
  }
}

}  // namespace troupe::python
