"""Messages about calls of the package's C++ functions with unsuitable arguments."""

import difflib
import operator
import os
import re
import reprlib
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

#: What an argument must be, for the types in the signatures that pybind11 writes.
_WORDS = {"int": "a whole number", "float": "a number", "str": "a text", "bool": "True or False", "os.PathLike": "a path",
          "dict": "a dict", "list": "a list", "List[str]": "a list of texts", "tuple": "a tuple", "function": "a function",
          "object": "a value", "troupe._core.Pose": "a troupe.Pose or a tuple (x, y, heading)"}

#: Types as pybind11 2.12 and newer write them (regular expressions), and as older versions write them.
_SPELLINGS = ((r"Annotated\[list\[(\w+)\], FixedSize\((\d+)\)\]", r"List[\1[\2]]"), (r"\blist\[", "List["),
              (r"\btuple\[", "Tuple["), (r"\bCallable\b", "function"))


class _Parameter(NamedTuple):
    name: str
    kind: str
    is_required: bool


class _Signature(NamedTuple):
    positional: List[_Parameter]  # those that may be given without a name
    named: List[_Parameter]  # those that must be given by name
    takes_all: Tuple[bool, bool]  # whether there are parameters *args and **kwargs


def _split(text: str) -> List[str]:
    """Splits a list at its commas, except those inside brackets and quotation marks."""
    parts, depth, quoted = [""], 0, False
    for character in text:
        quoted = quoted != (character == "'")
        depth += 0 if quoted else (character in "([{") - (character in ")]}")
        if character == "," and depth == 0 and not quoted:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts if part.strip()]


def _signature(text: str) -> _Signature:
    """Reads a signature such as "(file: os.PathLike, width: int = 1280, *, camera: str = 'top') -> None"."""
    for newer, older in _SPELLINGS:
        text = re.sub(newer, older, text)
    read = _Signature([], [], ("*args" in text, "**kwargs" in text))
    into = read.positional
    for part in _split(text[text.index("(") + 1:text.rindex(")")]):
        name, colon, rest = part.partition(": ")
        if part.startswith("*"):
            into = read.named
        elif colon:
            kind, default, _ = rest.partition(" = ")
            into.append(_Parameter(name, kind, not default))
    return read


def _inside(kind: str) -> List[str]:
    """The types in brackets: of "Union[dict, os.PathLike]", ["dict", "os.PathLike"]."""
    return _split(kind[kind.index("[") + 1:kind.rindex("]")])


def _words(kind: str) -> str:
    numbers = re.fullmatch(r"List\[float\[(\d+)\]\]", kind)
    if numbers:
        return f"a list of {numbers[1]} numbers"
    if kind.startswith(("Union[", "Optional[")):
        return " or ".join([*map(_words, _inside(kind)), *(["None"] if kind.startswith("Optional[") else [])])
    if kind == "numpy.ndarray":
        return "a NumPy array"
    if kind.startswith("numpy.ndarray"):
        return "an array of numbers"
    if kind.startswith("List[Tuple["):
        return f"a list of tuples ({', '.join(map(_words, _inside(_inside(kind)[0])))})"
    if kind.startswith("List[Union["):
        return f"a list whose elements are each {_words(_inside(kind)[0])}"
    other = "a list" if kind.startswith("List[") else kind.replace("troupe._core.", "a troupe.")
    return _WORDS.get(kind, other)


def is_number(value: Any) -> bool:
    """Whether pybind11 converts a value to a floating-point number."""
    try:
        return not isinstance(value, (str, bytes, bytearray)) and float(value) is not None
    except (TypeError, ValueError, OverflowError):
        return False


def _is_whole(value: Any) -> bool:
    try:
        return not isinstance(value, np.bool_) and operator.index(value) is not None
    except TypeError:
        return False


def _is_text(value: Any) -> bool:
    """Whether a value is a text that UTF-8 can represent, or bytes."""
    return isinstance(value, bytes) or isinstance(value, str) and not re.search("[\ud800-\udfff]", value)


def is_path(value: Any) -> bool:
    """Whether a value is a path that the file system can represent."""
    try:
        return b"\0" not in os.fsencode(value)
    except (TypeError, ValueError):  # such as half of a surrogate pair, which os.fsdecode() does not return
        return False


def _fits(kind: str, value: Any) -> Optional[bool]:
    """Whether a value may be an argument of a type; None if this cannot be told."""
    if kind.startswith("Optional["):
        return value is None or _fits(_inside(kind)[0], value)
    if kind.startswith("Union["):
        fit = [_fits(each, value) for each in _inside(kind)]
        return True if True in fit else None if None in fit else False
    if kind.startswith("List["):
        if isinstance(value, (str, bytes)) or not hasattr(value, "__iter__"):
            return False
        if "[float[" in kind or not isinstance(value, (list, tuple)):
            return None
        return all(_fits(_inside(kind)[0], each) is not False for each in value)
    if kind.startswith("Tuple["):
        kinds = _inside(kind)
        return isinstance(value, (list, tuple)) and len(value) == len(kinds) and False not in map(_fits, kinds, value)
    if kind == "numpy.ndarray":  # without an element type, pybind11 converts no list
        return isinstance(value, np.ndarray)
    if kind.startswith("numpy.ndarray"):
        if value is None:  # NaN for NumPy
            return False
        try:
            return np.asarray(value, dtype=float) is not None
        except (TypeError, ValueError):
            return False
    simple: Dict[str, bool] = {
        "object": True, "int": _is_whole(value), "float": is_number(value), "str": _is_text(value),
        "bool": value is None or hasattr(value, "__bool__"), "dict": isinstance(value, dict), "os.PathLike": is_path(value),
        "list": isinstance(value, list), "tuple": isinstance(value, tuple), "function": callable(value)}
    if kind == "troupe._core.Pose" and isinstance(value, tuple):  # pybind11 converts it
        return len(value) == 3 and all(_fits("float", each) for each in value)
    if kind.startswith("troupe._core."):
        return kind.rpartition(".")[2] in [each.__name__ for each in type(value).__mro__]
    return simple.get(kind)


def _fault(name: str, signature: _Signature, given: Sequence[Any], named: Mapping[str, Any]) -> Optional[str]:
    """What is wrong with the arguments of a call; None if this cannot be told."""
    parameters = {each.name: each for each in (*signature.positional, *signature.named)}
    count = len(signature.positional)
    for argument in named:
        if argument not in parameters and not signature.takes_all[1]:
            near = difflib.get_close_matches(argument, parameters, 1)
            return (f'{name}() has no keyword argument "{argument}"; known: {", ".join(parameters) if parameters else "none"}'
                    + (f' (did you mean "{near[0]}"?)' if near else ""))
    if len(given) > count and not signature.takes_all[0]:
        more = f": give {', '.join(each.name for each in signature.named)} by name" if signature.named else ""
        return f"{name}() takes at most {count} argument{'' if count == 1 else 's'} without a name, found {len(given)}{more}"
    values = dict(zip([each.name for each in signature.positional], given))
    for argument in named:
        if argument in values:
            return f'{name}() has two values for the argument "{argument}": one by position and one by name'
    values.update(named)
    for parameter in parameters.values():
        if parameter.is_required and parameter.name not in values:
            words = "" if parameter.kind == "object" else f": give {_words(parameter.kind)}"
            return f'{name}() needs the argument "{parameter.name}"{words}'
    fits = {each: _fits(parameters[each].kind, values[each]) for each in values if each in parameters}
    unsuitable = [each for each in fits if fits[each] is False] or [each for each in fits if fits[each] is None]
    if not unsuitable:  # only whole numbers can have a suitable type and still not fit, such as -1 for an index
        extreme = [each for each in fits if parameters[each].kind == "int" and not 0 <= operator.index(values[each]) < 1 << 16]
        found = ", ".join(f"{each}: found {values[each]}" for each in extreme)
        return f"{found}: {'the number' if len(extreme) == 1 else 'one of these numbers'} is out of range" if found else None
    if fits[unsuitable[0]] is None and len(unsuitable) > 1:
        return None
    wrong = unsuitable[0]
    return f"{wrong}: found {reprlib.repr(values[wrong])}: give {_words(parameters[wrong].kind)}"


def message(text: str, given: Sequence[Any], named: Mapping[str, Any]) -> str:
    """Returns a clear message for a call of a C++ function whose arguments do not fit.

    text   pybind11's message, which lists the signatures of the function
    given  the arguments without a name, the object of a method first
    named  the keyword arguments
    """
    found = re.match(r"(\w*)\(\): incompatible (constructor|function) arguments[^\n]*((?:\n    \d+\. [^\n]*)+)", text)
    if not found:
        return text
    name, _, all_lines = found.groups()
    lines = [line.split(". ", 1)[1] for line in all_lines.strip().split("\n")]
    signatures = [_signature(line) for line in lines]
    first = signatures[0].positional
    if found[2] == "constructor":
        name = lines[0].partition("(")[0].rpartition(".")[2]
        given = given[1:]
    elif first and first[0].name == "self":
        if not given or _fits(first[0].kind, given[0]) is False:
            return text
        for signature in signatures:
            del signature.positional[0]
        given = given[1:]
    if len(signatures) == 1:
        fault = _fault(name, signatures[0], given, named) or text
        return fault if name else fault.removeprefix("arg0: ")  # the setter of a property has no name
    forms = [", ".join(f"{each.name}: {_words(each.kind)}" for each in signature.positional) for signature in signatures]
    values = [*map(reprlib.repr, given), *(f"{each}={reprlib.repr(named[each])}" for each in named)]
    return f"{name}() takes ({') or ('.join(forms)}); found ({', '.join(values)})"
