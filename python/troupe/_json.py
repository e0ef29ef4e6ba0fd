"""JSON texts of worlds, studies and settings that a program gives as Python values."""

import json
import math
import os
import re
from typing import Any, Optional, Tuple

import numpy as np


def _plain(value: Any) -> Any:
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a value of the type {type(value).__name__} has no counterpart in JSON: give a dict, a list, a text, a "
                    f"number, a bool, None, a path or a NumPy array; found {value!r}")


def _not_finite(value: Any, pointer: str) -> Optional[Tuple[str, float]]:
    """Returns the JSON pointer of the first number in a value that is not finite, and the number; None if there is no
    such number. pointer: that of the value itself."""
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, float):
        return None if math.isfinite(value) else (pointer, value)
    items: Any = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, (list, tuple)) else ()
    for key, element in items:
        found = _not_finite(element, f"{pointer}/{str(key).replace('~', '~0').replace('/', '~1')}")
        if found:
            return found
    return None


def text_of(value: Any, at: str = "", **options: Any) -> str:
    """Returns the JSON text of a value, which may contain NumPy numbers and arrays, and paths. at: the JSON pointer of
    the value in the document that it belongs to. options: those of json.dumps(). Raises TypeError if the value has no
    counterpart in JSON, and ValueError for a number that is not finite, whose text names the JSON pointer of the
    number."""
    try:
        return json.dumps(value, allow_nan=False, default=_plain, **options)
    except ValueError as error:
        try:
            found = _not_finite(value, at)
        except RecursionError:  # a list that contains itself, as the error of json.dumps() says
            found = None
        if found is None:
            raise
        raise ValueError(f"{found[0] or 'the value'} is {found[1]}: give a finite number") from error


def without_lines(message: str, name: str, below: str = "") -> str:
    """Removes from the message of an error the lines of a text that is not a file. name: the name that the message has
    for the text. below: the JSON pointer of the content of the text in the document of the user, which is put before
    the pointers in the message."""

    def shown(found: "re.Match[str]") -> str:
        return f"{name}: {found[1]}: " + (f"{below}/" if found[2] else f"{below}: " if below else "")

    return re.sub(rf"^{re.escape(name)}:(?:\d+:)? (error|warning|note): (/)?", shown, message, flags=re.MULTILINE)
