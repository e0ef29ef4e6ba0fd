"""Tests that the type stubs match the module, that the package and a program that uses it match the stubs, and that
mismatches are found."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import troupe
from support import ROOT

GOOD = """
import numpy as np
import troupe
from troupe.envs import Navigation, VectorEnv

world = troupe.Simulation("worlds/hospital.json", robots=5, seed=1, set={"/title": "t"})
world = troupe.Simulation("worlds/hospital.json", set=[("/title", "t"), ("/seed", 1)])
swarm = world.swarm("minibot")
swarm.set_speeds(0.3, np.zeros(len(swarm)), where=swarm.alive())
x: float = world.find("r0").pose().x
shape: tuple[int, ...] = swarm.ranges().shape
turn: float = troupe.math.atan2(1.0, x)
turns = troupe.math.atan2(swarm.poses()[:, 1], swarm.poses()[:, 0])
turns.sum()
world.find("r0").set_pose((1.0, 2.0, 0.0))
world.run_for(1, lambda simulation: simulation.tick)


@world.on_tick
def look(simulation: troupe.Simulation) -> None:
    hit = simulation.cast((0.0, 0.0, 0.0), 3.0, without=world.find("r0"))
    print(hit.range_m + simulation.time_s, hit.body)


far: bool = world.run_until(lambda simulation: simulation.tick > 3, 1)
far = world.run_until(lambda simulation: (swarm.poses()[:, 0] > 1).all(), np.float32(1))
world.step(np.int64(2))
world = troupe.Simulation("worlds/hospital.json", robots=np.int64(5), seed=np.uint64(1), threads=np.int8(1))
world.picture(np.int64(64), center_m=swarm.poses()[0, :2], across_m=np.float64(3))
troupe.Measures(world, [lambda robots: np.float64(len(robots))])
world.on_tick(None)
values: dict[str, float] = dict(troupe.Measures(world, ["stalls"]))
columns = dict(world.table("pose"))["x"].sum()
color = world.find("r0").readings("ranges", "ir").sum()
hash: int = world.hashes()["pose"]
picture = world.picture()[:, :, 0]
env = VectorEnv(Navigation(robots=2), 8, threads=1)
copies: int = env.batch.core.copies
observations, infos = env.reset(seed=1, options={"level": 2})
env.batch.core.picture(0, camera="perspective")


class Roam(troupe.Controller):
    memory = {"turn": np.float32(0)}

    def decide(self, robots: troupe.Robots) -> None:
        robots.set_speeds(robots.ranges().min(axis=1) > 0.4, robots.normal())


@troupe.measure(unit="m")
def reach(robots: troupe.Swarm) -> float:
    return float(robots.poses()[:, 0].max())


world.film("f.mp4", 2, camera="top")
world.replay("page.html", seconds=2, every_s=0.2)
html: str = world._repr_html_()
"""
BAD = {
    "world.steps()": "attr-defined",
    "world.step('fast')": "arg-type",
    "text: str = world.tick": "assignment",
    "world.find('r0').set_speed(1)": "call-arg",
    "swarm.set_speeds(0.3, 0, 0.1)": "misc",
    "world.film('f.mp4')": "call-arg",
}


def run(*command, **options):
    environment = {**os.environ, "MYPYPATH": os.path.dirname(os.path.dirname(troupe.__file__))}
    environment.pop("PYTHONPATH", None)
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment, **options)


class Types(unittest.TestCase):
    def mypy(self, *arguments):
        with tempfile.TemporaryDirectory() as cache:
            return run("mypy", "--config-file", ROOT / "pyproject.toml", "--cache-dir", cache, *arguments)

    def test_the_package_is_typed(self):
        done = self.mypy("--package", "troupe")
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_programs_that_are_right_pass_and_others_do_not(self):
        lines = GOOD.strip().splitlines()
        with tempfile.TemporaryDirectory() as folder:
            program = os.path.join(folder, "program.py")
            with open(program, "w") as file:
                file.write("\n".join([*lines, *BAD]) + "\n")
            done = self.mypy(program)
        found = [line for line in done.stdout.splitlines() if "program.py" in line and "error:" in line]
        self.assertEqual(len(found), len(BAD), done.stdout)
        for number, (line, (code, kind)) in enumerate(zip(found, BAD.items()), len(lines) + 1):
            self.assertIn(f"program.py:{number}: error:", line)
            self.assertIn(f"[{kind}]", line, code)

    def test_the_stubs_are_those_of_the_module(self):
        path = os.path.dirname(os.path.dirname(troupe.__file__))
        done = subprocess.run(["stubtest", "--concise", "troupe._core", "troupe.math"], cwd=ROOT, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, env={**os.environ, "PYTHONPATH": path, "MYPYPATH": path})
        # Differences that pybind11 causes in every class and that stubs cannot express.
        usual = re.compile(r"metaclass differs|__init__ is inconsistent, stub does not have \*args")
        findings = [line for line in done.stdout.splitlines() if line.startswith("troupe") and not usual.search(line)]
        self.assertEqual(findings, [], done.stdout)
        self.assertIn("metaclass differs", done.stdout)  # because stubtest has compared the classes


if __name__ == "__main__":
    if not (shutil.which("mypy") and shutil.which("stubtest")):
        print("skipped: no mypy; scripts/setup --checks installs it")
        sys.exit(77)
    unittest.main()
