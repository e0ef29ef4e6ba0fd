"""Runs the example train_navigation.py for a short time, with the library skrl.

skrl with JAX needs a download of 200 MB, so that this test does not install it, but uses it if it is installed:

    build/release/python_packages-3.11/bin/pip install "skrl[jax]==2.1.1" "jax<0.7" "numpy<2"

Otherwise the test is skipped: it prints the reason and ends with 77.
"""

import importlib.util
import sys
import unittest

from packages import run_with_packages
from support import InAFolder, table, train

if __name__ == "__main__":
    run_with_packages()
    missing = [name for name in ("skrl", "jax", "flax", "optax") if importlib.util.find_spec(name) is None]
    if missing:
        print(f"SKIPPED: train_navigation.py needs packages that are not installed: {', '.join(missing)}; install them with\n"
              f"  {sys.executable} -m pip install 'skrl[jax]==2.1.1' 'jax<0.7' 'numpy<2'")
        sys.exit(77)


class Training(InAFolder):
    def test_ppo(self):
        done = train("train_navigation.py", "--seeds", 1, "--samples", 81920, "--reach", -1000)
        self.assertEqual(done.returncode, 0, done.stdout)
        rows = table("out/navigation.csv")
        self.assertEqual([int(row["samples"]) for row in rows], [0, 81920])
        self.assertGreater(float(rows[1]["return"]), float(rows[0]["return"]) + 2)


if __name__ == "__main__":
    unittest.main()
