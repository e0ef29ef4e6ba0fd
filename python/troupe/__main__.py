"""Runs the program `troupe` in a Python interpreter: `python3 -m troupe run world.json`. The program itself starts this
module for commands that need Python, such as `troupe run world.json --controller my.py`."""

import sys

from ._core import _run_program

if __name__ == "__main__":
    sys.exit(_run_program(["troupe", *sys.argv[1:]]))
