"""Runs the program `troupe` in a Python interpreter: `python3 -m troupe run world.json`. The program itself starts this
module for commands that need Python, such as `troupe run world.json --controller my.py`. The command `troupe` that pip
installs is the function main()."""

import os
import sys

from ._core import _run_program


def main() -> int:
    """Runs the program with the arguments of this process and returns its exit code."""
    if not os.environ.get("TROUPE_PYTHON") and sys.executable:
        os.environ["TROUPE_PYTHON"] = sys.executable  # for commands that start Python, such as troupe plot
    return _run_program([b"troupe", *map(os.fsencode, sys.argv[1:])])  # names of files need not be UTF-8


if __name__ == "__main__":
    sys.exit(main())
