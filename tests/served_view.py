"""The same as served_view.cpp, with the Python package: python3 served_view.py WORLD"""

import sys

import troupe


def say(line):
    """Prints a line with one call of write: the launcher may put the output of another process between two calls."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


try:
    troupe.Simulation(sys.argv[1], threads=1, ranks=2)
    say("error none")
except ValueError as error:
    say(f"error {error}")
simulation = troupe.Simulation(sys.argv[1], threads=1)
view = simulation.view(rate=0)
say(f"view {view.address}")
view.run(for_s=1)
say(f"hash {simulation.state_hash():016x}")
