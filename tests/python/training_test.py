"""Runs the example evolve_dispersion.py for a short time, with the library cma."""

import unittest

from packages import run_with_packages
from support import InAFolder, table, train

if __name__ == "__main__":
    run_with_packages()


class Training(InAFolder):
    def test_evolution(self):
        done = train("evolve_dispersion.py", "--seeds", 7, "--generations", 8, "--reach", 20)
        self.assertEqual(done.returncode, 0, done.stdout)
        rows = table("out/dispersion.csv")
        self.assertEqual([int(row["generation"]) for row in rows], list(range(8)))
        self.assertGreater(float(rows[-1]["median"]), float(rows[0]["median"]))
        done = train("evolve_dispersion.py", "--seeds", 7, "--generations", 1, "--reach", 1000)
        self.assertEqual(done.returncode, 1)
        self.assertIn("the mean return of the last test is below 1000.0 for the seeds [7]", done.stdout)

    def test_options(self):
        for options, text in (
            (("--seeds", 1, 0), "error: --seeds: give whole numbers from 1 to 4294967295"),
            (("--generations", 0), "error: --generations: found 0: give 1 or more"),
        ):
            done = train("evolve_dispersion.py", "--generations", 1, *options)
            self.assertEqual(done.returncode, 2)
            self.assertIn(text, done.stdout)


if __name__ == "__main__":
    unittest.main()
