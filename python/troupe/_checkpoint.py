"""Functions of Simulation that are written in Python: checkpoints in memory."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Union

from ._core import InputError, Simulation

_FILE = "checkpoint.h5"


def to_bytes(self: Simulation) -> bytes:
    """Returns a checkpoint, the content of the file that save() writes. from_bytes() continues from it, also in another
    process. Raises RuntimeError as save() does."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, _FILE)
        self.save(file)
        with open(file, "rb") as stream:
            return stream.read()


def from_bytes(data: Union[bytes, bytearray, memoryview], **options: Any) -> Simulation:
    """Returns a new simulation that continues from a checkpoint of to_bytes(). options: the keyword arguments of
    resume(). Raises TypeError if `data` is not bytes, and the exceptions of resume()."""
    if not isinstance(data, (bytes, bytearray, memoryview)):
        raise TypeError(f"data: found {data!r}: give the bytes that to_bytes() has returned")
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, _FILE)
        with open(file, "wb") as stream:
            stream.write(data)
        try:
            return Simulation.resume(file, **options)
        except InputError as error:
            raise InputError(str(error).replace(file, "data")) from None
        except TypeError as error:
            if not str(error).startswith("resume() has "):
                raise
            text = str(error).replace("resume()", "from_bytes()", 1).replace("; known: checkpoint, ", "; known: data, ")
            raise TypeError(text) from None


setattr(Simulation, "to_bytes", to_bytes)
setattr(Simulation, "from_bytes", staticmethod(from_bytes))
