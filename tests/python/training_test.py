"""Runs the training scripts of python/examples for a short time, with the libraries that they use.

skrl with JAX needs a download of 200 MB, so that this test does not install it, but uses it if it is installed:

    build/release/python_packages-3.11/bin/pip install "skrl[jax]==2.1.1" "jax<0.7" "numpy<2"
"""

import csv
import importlib.util
import subprocess
import sys
import unittest

from packages import run_with_packages
from support import ROOT, InAFolder

if __name__ == "__main__":
    run_with_packages()

EXAMPLES = ROOT / "python" / "examples"


def train(script, *arguments):
    done = subprocess.run([sys.executable, EXAMPLES / script, *map(str, arguments), "--out", "out"], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(done.stdout, end="")
    return done


def table(file):
    with open(file, newline="") as stream:
        return list(csv.DictReader(stream))


class Training(InAFolder):
    def test_evolution(self):
        done = train("evolve_dispersion.py", "--seeds", 7, "--generations", 8, "--reach", 20)
        self.assertEqual(done.returncode, 0, done.stdout)
        rows = table("out/dispersion.csv")
        self.assertEqual([int(row["generation"]) for row in rows], list(range(8)))
        self.assertGreater(float(rows[-1]["median"]), float(rows[0]["median"]))
        done = train("evolve_dispersion.py", "--seeds", 7, "--generations", 1, "--reach", 1000)
        self.assertEqual(done.returncode, 1)
        self.assertIn("return 1000.0 not reached from the seeds [7]", done.stdout)

    def test_ppo(self):
        missing = [name for name in ("skrl", "jax", "flax", "optax") if importlib.util.find_spec(name) is None]
        if missing:
            reason = f"train_navigation.py needs packages that are not installed: {', '.join(missing)}"
            print(f"SKIPPED: {reason}")
            self.skipTest(reason)
        done = train("train_navigation.py", "--seeds", 1, "--samples", 81920, "--reach", -1000)
        self.assertEqual(done.returncode, 0, done.stdout)
        rows = table("out/navigation.csv")
        self.assertEqual([int(row["samples"]) for row in rows], [0, 81920])
        self.assertGreater(float(rows[1]["return"]), float(rows[0]["return"]) + 2)


if __name__ == "__main__":
    unittest.main()
