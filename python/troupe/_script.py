"""Reads scripts: Python files with controllers and measures, given by `--controller` or `Simulation(controllers=...)`.

load() returns descriptions of the controllers and measures of a script. The C++ part of the package (python/script.cpp)
makes them available in worlds, like controllers and measures that are written in C++.
"""

from __future__ import annotations

import difflib
import hashlib
import importlib.util
import inspect
import os
import stat
import sys
import traceback
import warnings
from types import ModuleType, TracebackType
from typing import Any, Callable, Dict, Iterable, List, NoReturn, Optional, Sequence, Tuple, TypeVar, Union, overload

import numpy as np

from ._core import InputError, Robots, Swarm, _units

_ELEMENTS = ("f8", "f4", "i8", "i4", "u8", "u4", "u1")
_Function = TypeVar("_Function", bound=Callable[..., Any])
# Results of load(), by the name and the hash of a file, or by classes and what they declare.
_loaded: Dict[Tuple[object, ...], Dict[str, Any]] = {}


class Controller:
    """Base class of controllers in Python (docs/python.md).

    A derived class defines decide(self, robots). decide() is called in each tick, once per type, for all robots of the
    type that decide in this tick; `robots` is a troupe.Robots. An exception in decide() makes the step raise StepError.
    Class attributes:

    robots  name of the type, population or robot that the controller controls; "": all types with a drive
    uses    list of the names or kinds of the devices that the controller uses (a kind selects the first device of this
            kind that is not yet in the list); None: all devices of the robot
    memory  the fields of each robot's memory: a dict from names to initial values (NumPy scalars or one-dimensional
            arrays) or to NumPy types, which stand for an initial value of 0. decide() finds them in `robots.memory`.
            The engine owns, hashes, saves and resets the memory
    params  the parameters: a dict from names to default values, each a bool, an int, a float, a str or a list of
            floats. decide() finds the values in `robots.params`. A world file gives other values as keys of the
            controller, as in {"kind": "my", "speed": 0.5}, and Simulation.set() changes them during a run
    name    name of the controller; None: the name of the class. In world files and in components of the state, the
            controller NAME of the script my.py is called `my:NAME`, or `my` if NAME is `my`

    Data of a robot belong in its memory. An instance must have no attributes of its own, because hashes, checkpoints
    and resets would not include them.
    """

    robots: str = ""
    uses: Optional[Sequence[str]] = None
    memory: Dict[str, Any] = {}
    params: Dict[str, Any] = {}
    name: Optional[str] = None

    def decide(self, robots: Robots) -> None:
        raise NotImplementedError(f"{type(self).__name__} has no decide(self, robots): define it, to command the robots")

    def __getattribute__(self, name: str) -> Any:
        if name == "params":  # the defaults, which the world may replace
            raise AttributeError("a controller has no attribute \"params\" of its own: read robots.params, which has the "
                                 "values of the parameters")
        return super().__getattribute__(name)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(
            f"a controller cannot have the attribute \"{name}\": declare it in `memory`, which the engine saves")


@overload
def measure(function: _Function) -> _Function: ...
@overload
def measure(*, unit: str = ..., name: Optional[str] = ...) -> Callable[[_Function], _Function]: ...
def measure(function: Optional[Callable[..., Any]] = None, *, unit: str = "", name: Optional[str] = None) -> Any:
    """Declares a function of a script as a measure: the argument of the function is a Swarm with the robots for which
    the measure is computed, and its result is a number.

        @troupe.measure(unit="m")
        def reach(robots):
            return np.abs(robots.poses()[:, 0]).max()

    unit: unit of the result, such as "m"; an unknown unit raises ValueError, whose text lists the known units. name:
    name of the measure; None: the name of the function. In the script my.py, this example declares the measure
    `my:reach`. Troupe does not guarantee that measures in Python have the same bits on every machine.
    """

    if function is not None and not callable(function):
        raise TypeError(f'measure() found {function!r} in place of a function: write @troupe.measure(unit="m") to give a unit')
    if unit and unit not in _units():
        raise ValueError(f'unknown unit "{unit}"; known: {", ".join(_units())}; for other units leave `unit` out, and name '
                         "the unit in the name of the measure")

    def declare(function: Callable[..., Any]) -> Callable[..., Any]:
        own = name or getattr(function, "__name__", None)
        if own is None:  # such as a functools.partial
            raise TypeError(f"the function {function!r} has no name: give it one with troupe.measure(function, name=...)")
        setattr(function, "_troupe_measure", {"unit": unit, "name": own})
        return function

    return declare if function is None else declare(function)


def _attribute_hint(error: BaseException) -> str:
    """Returns a hint for an unknown attribute: a similar one, and for the robots of a controller or measure all that
    they have."""
    name, owner = getattr(error, "name", None), getattr(error, "obj", None)  # since Python 3.10
    if not isinstance(error, AttributeError) or name is None or owner is None:
        return ""
    known = [each for each in dir(owner) if not each.startswith("_")]
    near = difflib.get_close_matches(name, known, 1)
    return ((f"; known: {', '.join(known)}" if isinstance(owner, (Robots, Swarm)) else "")
            + (f' (did you mean "{near[0]}"?)' if near else ""))


def _unknown(what: str, name: str, known: Iterable[str]) -> str:
    """Returns the text of an error for an unknown name, with the known names and a similar one."""
    names = sorted(known)
    near = difflib.get_close_matches(name, names, 1)
    return (f'unknown {what} "{name}"; known: {", ".join(names) if names else "none"}'
            + (f' (did you mean "{near[0]}"?)' if near else ""))


def _absolute(file: str) -> str:
    try:
        return os.path.abspath(file)
    except FileNotFoundError:  # the working folder has been removed
        return file


def _line_and_text(file: str, error: BaseException, trace: Optional[TracebackType]) -> Tuple[int, str]:
    path = _absolute(file)
    if isinstance(error, SyntaxError) and error.filename and _absolute(error.filename) == path:
        return error.lineno or 0, f"{type(error).__name__}: {error.msg}"
    lines = [frame.lineno for frame in traceback.extract_tb(trace) if _absolute(frame.filename) == path]
    if not lines and isinstance(error, ResultError):
        return error.lineno, str(error)
    text = f": {error}{_attribute_hint(error)}" if str(error) else ""
    return (lines[-1] or 0) if lines else 0, f"{type(error).__name__}{text}"


def error_text(file: str, error: BaseException, trace: Optional[TracebackType]) -> str:
    """Returns the text of an exception, preceded by `file` and a line number, as in "my.py:7: ValueError: ...". The
    line is the line of this file that raised the exception, or that called the code that raised it. If the file has no
    such line, the number is left out."""
    line, text = _line_and_text(file, error, trace)
    return f"{file}:{line}: {text}" if line else f"{file}: {text}"


def _fail(file: str, line: int, text: str) -> NoReturn:
    raise InputError(f"{file}:{line}: error: {text}" if line else f"{file}: error: {text}") from None


def _row_type(cls: Any, file: str, line: int) -> Tuple[List[Tuple[str, Any, int, int]], Any, bytes]:
    """Returns the fields of the memory of a controller class as tuples (name, type, columns, offset), the NumPy type of
    the memory of one robot, and the initial bytes of this memory. The engine stores a bool as an unsigned byte."""
    if not isinstance(cls.memory, dict):
        _fail(file, line, f"{cls.__name__}.memory is {cls.memory!r}: expected a dict of names and NumPy values or types")
    fields: List[Tuple[str, Any, int, int]] = []
    formats: List[Any] = []
    starts: List[Tuple[int, bytes]] = []
    offset = 0
    for name, given in cls.memory.items():
        where = f"{cls.__name__}.memory[{name!r}]"
        if not isinstance(name, str) or not name.isidentifier():
            _fail(file, line, f"{where}: the name of a field must be a Python identifier")
        try:
            is_value = isinstance(given, (np.generic, np.ndarray))
            start = np.asarray(given) if is_value else np.zeros((), np.dtype(given))
            if start.dtype.subdtype is not None:
                start = np.zeros(start.dtype.subdtype[1], start.dtype.subdtype[0])
        except TypeError:
            _fail(file, line, f"{where} is {given!r}: expected a NumPy scalar, array or type, as in np.float32(0)")
        kind = np.dtype("u1") if start.dtype == np.bool_ else start.dtype
        if kind.newbyteorder("=").str[1:] not in _ELEMENTS or not kind.isnative or start.ndim > 1 or start.size == 0:
            _fail(file, line, f"{where} has the type {start.dtype} and the shape {start.shape}: expected a number of "
                              "one of the types float64, float32, int64, int32, uint64, uint32, uint8 or bool, or a "
                              "one-dimensional array of such numbers")
        offset += -offset % kind.itemsize
        fields.append((name, kind, start.size, offset))
        formats.append(start.dtype if start.size == 1 else (start.dtype, (start.size,)))
        starts.append((offset, start.tobytes()))
        offset += kind.itemsize * start.size
    size = offset + -offset % max([1, *(kind.itemsize for _, kind, _, _ in fields)])
    bytes_ = bytearray(size)
    for at, value in starts:
        bytes_[at:at + len(value)] = value
    row: Any = np.dtype({"names": [f[0] for f in fields], "offsets": [f[3] for f in fields], "itemsize": size,
                         "formats": formats}) if fields else np.dtype("V0")
    return fields, row, bytes(bytes_)


def _params(cls: Any, file: str, line: int) -> List[Tuple[str, Any]]:
    """Returns the names and default values of the parameters of a controller class. A default value is a bool, an int,
    a float, a str or a list of floats."""
    if not isinstance(cls.params, dict):
        _fail(file, line, f"{cls.__name__}.params is {cls.params!r}: expected a dict of names and default values")
    params: List[Tuple[str, Any]] = []
    for name, given in cls.params.items():
        where = f"{cls.__name__}.params[{name!r}]"
        if not isinstance(name, str) or not name.isidentifier() or not name.isascii():
            _fail(file, line, f"{where}: the name of a parameter must be a Python identifier of ASCII characters")
        value = given.item() if isinstance(given, np.generic) else given
        if isinstance(value, (list, tuple, np.ndarray)):
            try:
                value = [float(number) for number in value]
            except (TypeError, ValueError):
                value = None
        numbers = value if isinstance(value, list) else [value] if isinstance(value, float) else []
        is_too_large = isinstance(value, int) and not -(1 << 63) <= value < 1 << 63
        if not isinstance(value, (bool, int, float, str, list)) or is_too_large or not np.isfinite(numbers).all():
            _fail(file, line, f"{where} is {given!r}: expected a bool, an int of 64 bits, a finite float, a str or a list "
                              "of finite floats")
        params.append((name, value))
    return params


def _require_fit(name: str, field: "np.dtype[Any]", given: Any) -> None:
    """Raises TypeError if values have a type that a field of a memory cannot store without loss, such as floats in a
    field of integers, and ValueError if the field has integers or bools and an integer is out of their range."""
    values = np.asarray(given)
    if np.can_cast(values.dtype, field, "safe"):
        return
    are_whole = field.kind in "biu" and values.dtype.kind in "iu"
    if not are_whole and not np.can_cast(values.dtype, field, "same_kind"):
        raise TypeError(f"memory[{name!r}] has the type {field}, which cannot store values of the type {values.dtype} "
                        f"without loss: convert them, as in x.astype({field.name!r})")
    if are_whole and values.size:
        least, most = (0, 1) if field.kind == "b" else (np.iinfo(field).min, np.iinfo(field).max)
        for value in (int(values.min()), int(values.max())):
            if not least <= value <= most:
                raise ValueError(f"memory[{name!r}] has the type {field}, which cannot store {value}: give whole numbers "
                                 f"from {least} to {most}")


class Parameters(Dict[str, Any]):
    """The parameters of a controller: names and values. The text of the KeyError for an unknown name lists the
    names."""

    def __missing__(self, name: str) -> NoReturn:
        raise KeyError(_unknown("parameter", str(name), self))


class Memory(np.ndarray):  # type: ignore[type-arg]
    """The memories of robots: a structured array. Assignments to a field, and to a part of a field, raise TypeError for
    floats in a field of integers, and ValueError for integers that are out of range. They convert floats of other sizes
    as NumPy does, even if they lose digits."""

    def _require_field(self, key: Any) -> None:
        names = self.dtype.names or ()
        if isinstance(key, str) and key not in names:
            raise ValueError(_unknown("field of the memory", key, names))

    def __getitem__(self, key: Any) -> Any:
        self._require_field(key)
        value = super().__getitem__(key)
        if not isinstance(value, Memory) or value.dtype.names is not None:
            return value
        field = value.view(_Field)
        field.name = key
        return field

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f'the memory has no attribute "{name}": its fields are written as in memory["{name}"]')

    def __setattr__(self, name: str, value: Any) -> None:
        if not hasattr(np.ndarray, name):  # NumPy would store the value in this array, which ends with the call of decide
            self.__getattr__(name)
        super().__setattr__(name, value)

    def __setitem__(self, key: Any, value: Any) -> None:
        self._require_field(key)
        if isinstance(key, str):
            _require_fit(key, self.dtype[key].base, value)
        super().__setitem__(key, value)  # type: ignore[no-untyped-call]


class _Field(np.ndarray):  # type: ignore[type-arg]
    """A field of a Memory, or a part of it. Results of computations with it are usual NumPy arrays."""

    name = ""

    def __array_finalize__(self, source: Any) -> None:
        self.name = getattr(source, "name", "")

    def __array_wrap__(self, array: Any, *_: Any) -> Any:
        return array if array is self else array.view(np.ndarray)[()]

    def __setitem__(self, key: Any, value: Any) -> None:
        _require_fit(self.name, self.dtype, value)
        super().__setitem__(key, value)  # type: ignore[no-untyped-call]


def _line_of(thing: Any) -> int:
    """Returns the line at which a class or a function begins; 0 if its source is not known, as that of exec()."""
    try:
        return inspect.getsourcelines(thing)[1]
    except (OSError, TypeError):
        return 0


def _check_decide(cls: Any, instance: Any, file: str, line: int) -> None:
    if cls.decide is Controller.decide:
        _fail(file, line, f"{cls.__name__} has no function decide(self, robots): define it, to command the robots")
    is_async = inspect.iscoroutinefunction(cls.decide) or inspect.isasyncgenfunction(cls.decide)
    if is_async or inspect.isgeneratorfunction(cls.decide):
        _fail(file, _line_of(cls.decide),
              f"{cls.__name__}.decide: a call would execute none of its statements: write it without "
              f"`{'async' if is_async else 'yield'}`")
    try:
        inspect.signature(instance.decide).bind(None)
    except TypeError:
        _fail(file, _line_of(cls.decide),
              f"{cls.__name__}.decide{inspect.signature(cls.decide)}: expected decide(self, robots)")


class ResultError(TypeError):
    """Raised if a measure of a script returns a result that is not a number. lineno: the line at which the function
    of the measure begins; 0 if it is not known."""

    lineno = 0


def number_of(function: Any, value: Any) -> float:
    """Returns `value`, the result of the measure `function`, as a float. Raises ResultError if the value is not a
    number."""
    try:
        if isinstance(value, (str, bytes)) or np.ndim(value) > 0:
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        found = f"an array of shape {np.shape(value)}" if np.ndim(value) > 0 else repr(value)
        error = ResultError(f"the measure {getattr(function, '__name__', function)} returned {found}, expected a number")
        error.lineno = getattr(getattr(function, "__code__", None), "co_firstlineno", 0)
        raise error from None


def misspelt_members(base: type, own: Iterable[str]) -> List[Tuple[str, str]]:
    """Returns the public names in `own` that `base` does not define but that are similar to a member of `base`, each
    with the name of this member, in alphabetical order. own: names of the attributes of a class derived from `base`."""
    members = [name for name in vars(base) if not name.startswith("_")]
    near = [(name, difflib.get_close_matches(name, members, 1, 0.85))
            for name in sorted(set(own).difference(members)) if not name.startswith("_")]
    return [(name, found[0]) for name, found in near if found]


def _warn_of_misspelt_attributes(cls: Any, file: str, line: int) -> None:
    """Warns of attributes such as `robot`: without `robots`, a controller commands all types with a drive."""
    own = [name for each in cls.__mro__ if issubclass(each, Controller) for name in vars(each)]
    for name, near in misspelt_members(Controller, own):
        warnings.warn_explicit(
            f'{cls.__name__} has the attribute "{name}", which Controller does not use: did you mean "{near}"?', UserWarning,
            file, line)


def _controller(cls: Any, file: str) -> Dict[str, Any]:
    line = _line_of(cls)
    _warn_of_misspelt_attributes(cls, file, line)
    if not isinstance(cls.robots, str):
        _fail(file, line, f"{cls.__name__}.robots is {cls.robots!r}: expected the name of a type, a population or a robot")
    uses = cls.uses
    if uses is not None and (isinstance(uses, str) or not all(isinstance(use, str) for use in uses)):
        _fail(file, line, f"{cls.__name__}.uses is {uses!r}: expected a list of names of devices")
    if cls.name is not None and not isinstance(cls.name, str):
        _fail(file, line, f"{cls.__name__}.name is {cls.name!r}: expected a text, or None for the name of the class")
    fields, row, start = _row_type(cls, file, line)
    try:
        instance = cls()
    except Exception as error:
        _fail(file, *_line_and_text(file, error, error.__traceback__))
    _check_decide(cls, instance, file, line)
    return {
        "name": cls.name or cls.__name__, "text": ((inspect.getdoc(cls) if cls.__doc__ else None) or "").split("\n")[0],
        "robots": cls.robots, "line": line, "uses": None if uses is None else list(uses), "fields": fields,
        "memory": row, "start": start, "decide": instance.decide, "params": _params(cls, file, line),
    }


def _measure(function: Any) -> Dict[str, Any]:
    declared = function._troupe_measure
    text, _, definition = (inspect.getdoc(function) or "a function in Python").partition("\n")
    return {"name": declared["name"], "unit": declared["unit"], "function": function, "text": text,
            "definition": " ".join(definition.split())}


def _execute(file: str) -> ModuleType:
    name = os.path.splitext(os.path.basename(file))[0]
    try:
        spec = importlib.util.spec_from_file_location(f"troupe_script_{name}", file)
        assert spec is not None and spec.loader is not None  # because the name ends in .py
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        spec.loader.exec_module(module)
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        _fail(file, *_line_and_text(file, error, error.__traceback__))
    return module


def _of_file(source: Union[str, os.PathLike[str]]) -> Dict[str, Any]:
    file = os.fsdecode(source)
    name = os.fsencode(file).decode(errors="backslashreplace")
    if name != file:
        raise InputError(f"{name}: error: the name of a script must be UTF-8: rename the file")
    try:
        mode = os.stat(file).st_mode
        if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):  # opening a pipe could block for ever
            raise InputError(f"{file}: error: this is a pipe or a device, not a regular file")
        with open(file, "rb") as stream:
            contents = hashlib.sha256(stream.read()).hexdigest()
    except FileNotFoundError:
        raise InputError(f"{file}: error: there is no such file") from None
    except OSError as error:
        raise InputError(f"{file}: error: cannot be read: {error.strerror}") from None
    if not file.endswith(".py"):
        raise InputError(f"{file}: error: the name of a script must end in .py")
    key = (os.path.abspath(file), contents)
    if key not in _loaded:
        module = _execute(file)
        own = [each for each in vars(module).values() if getattr(each, "__module__", None) == module.__name__]
        classes = [each for each in own if isinstance(each, type) and issubclass(each, Controller)]
        functions = [each for each in own if hasattr(each, "_troupe_measure")]
        for each in own:
            if isinstance(each, type) and hasattr(each, "decide") and not any(issubclass(cls, each) for cls in classes):
                _fail(file, _line_of(each), f'class "{each.__name__}" has decide(), but is not a troupe.Controller: write '
                      f"class {each.__name__}(troupe.Controller), or give the function another name")
        if not classes and not functions:
            raise InputError(f"{file}: error: the script has no class derived from troupe.Controller, and no function "
                             "declared with @troupe.measure")
        _loaded[key] = {"file": file, "controllers": [_controller(each, file) for each in classes],
                        "measures": [_measure(each) for each in functions]}
    return _loaded[key]


def _declared(cls: Any, file: str) -> Tuple[object, ...]:
    """Returns what a description of a class is made from: the class, its function decide, and the text of its other
    members. A program may change these between two simulations."""
    line = _line_of(cls)
    fields, _, start = _row_type(cls, file, line)
    members = (cls.robots, cls.uses, cls.name, cls.__doc__, fields, start, _params(cls, file, line))
    return cls, cls.decide, repr(members)


def _of_classes(file: str, classes: Sequence[Any]) -> Dict[str, Any]:
    key = tuple(_declared(each, file) for each in classes)
    if key not in _loaded:
        _loaded[key] = {"file": file, "controllers": [_controller(each, file) for each in classes], "measures": []}
    return _loaded[key]


def _file_of(cls: Any) -> str:
    if not (isinstance(cls, type) and issubclass(cls, Controller)):
        raise TypeError(f"controllers: {cls!r} is neither the name of a script nor a class derived from troupe.Controller")
    try:
        return inspect.getsourcefile(cls) or f"{cls.__name__}.py"
    except (TypeError, OSError):  # a class that was typed into an interpreter
        return f"{cls.__name__}.py"


def load(sources: Any) -> List[Dict[str, Any]]:
    """Returns one description, a dict, for each script and for each file that defines some of the given classes.
    sources: the name of a script, a class derived from Controller, or a sequence of these. Raises InputError for a
    script that cannot be read or executed or that defines nothing, and TypeError for a source that is neither a name
    nor such a class."""
    if isinstance(sources, (str, os.PathLike, type)) or not hasattr(sources, "__iter__"):
        sources = [sources]
    descriptions: List[Dict[str, Any]] = []
    classes: Dict[str, List[Any]] = {}
    for source in sources:
        if isinstance(source, (str, os.PathLike)):
            descriptions.append(_of_file(source))
        else:
            classes.setdefault(_file_of(source), []).append(source)
    return descriptions + [_of_classes(file, those) for file, those in classes.items()]
