"""The same as served_view.cpp, with the Python package: python3 served_view.py WORLD"""

import sys

import troupe

try:
    troupe.Simulation(sys.argv[1], threads=1, ranks=2)
    print("error none")
except ValueError as error:
    print("error", error)
simulation = troupe.Simulation(sys.argv[1], threads=1)
view = simulation.view(rate=0)
print("view", view.address, flush=True)
view.run(for_s=1)
print(f"hash {simulation.state_hash():016x}")
