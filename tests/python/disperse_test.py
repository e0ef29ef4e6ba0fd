"""Tests that python/examples/disperse.py, a controller in NumPy, gives the same bits as the controller in C++, and calls no
function for each robot."""

import importlib.util
import os
import re
import subprocess
import sys
import unittest

import numpy as np
import troupe
from support import HOSPITAL, ROOT, calls_of

EXAMPLE = ROOT / "python" / "examples" / "disperse.py"
spec = importlib.util.spec_from_file_location("disperse", EXAMPLE)
disperse = importlib.util.module_from_spec(spec)
spec.loader.exec_module(disperse)


def golden(world, tick):
    for line in (ROOT / "worlds" / "golden_hashes.txt").read_text().splitlines():
        if line.split()[:3] == [world, "-", str(tick)]:
            return int(line.split()[3], 16)
    raise LookupError(f"{world} has no hash at tick {tick}")


class Dispersal(unittest.TestCase):
    def test_ends_in_the_state_of_the_controller_in_c_plus_plus(self):
        for threads in (1, 2):
            world = disperse.load(str(HOSPITAL), threads=threads)
            swarm = world.swarm()
            directions = troupe.math.sincos(swarm.bearings())
            world.run_for(5, lambda _: disperse.disperse(swarm, directions))
            self.assertEqual(len(swarm), 2000)
            self.assertEqual(f"{world.state_hash():016x}", f"{golden('hospital.json', 50):016x}")

    def test_other_arithmetic_is_noticed(self):
        world = disperse.load(str(HOSPITAL))
        swarm = world.swarm()
        directions = np.sin(swarm.bearings()), np.nextafter(np.cos(swarm.bearings()), 0)
        world.run_for(5, lambda _: disperse.disperse(swarm, directions))
        self.assertNotEqual(world.state_hash(), golden("hospital.json", 50))

    def test_the_controller_has_at_most_ten_lines(self):
        body = re.search(r'def disperse\(.*?\n\n\n', EXAMPLE.read_text(), re.S)[0].strip().splitlines()
        self.assertLessEqual(len(body), 10, body)

    def test_python_is_called_as_often_for_a_thousand_robots_as_for_ten(self):
        calls = []
        for count in (10, 1000):
            world = disperse.load(str(HOSPITAL), threads=1, robots=count)
            swarm = world.swarm()
            directions = troupe.math.sincos(swarm.bearings())
            for _ in range(2):  # the first calls may fill caches
                disperse.disperse(swarm, directions)
                world.step()
            calls.append(calls_of(lambda: disperse.disperse(swarm, directions)))
        self.assertEqual(*calls)
        self.assertGreater(calls[0], 10)

    def test_the_example_runs(self):
        done = subprocess.run(
            [sys.executable, EXAMPLE, HOSPITAL, "1"], cwd=os.path.dirname(EXAMPLE), stdout=subprocess.PIPE, text=True, check=True
        )
        self.assertRegex(done.stdout, r"^2000 robots, 10 ticks, state [0-9a-f]{16} in both simulations\nNumPy ")


if __name__ == "__main__":
    unittest.main()
