"""The program `troupe`, in a Python interpreter: `troupe run world.json --controller my.py` executes this module."""

import sys

from ._core import _run_program

if __name__ == "__main__":
    sys.exit(_run_program(["troupe", *sys.argv[1:]]))
