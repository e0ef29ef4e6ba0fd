"""Tests that TROUPE_SIMD, set before the module is imported, selects the instruction set for range finding."""

import os
import subprocess
import sys
import unittest

SHOW = """
import troupe
world = '{"troupe": 1, "types": {"bot": {"size_m": [0.4, 0.4, 0.4]}}, "models": [{"name": "r", "type": "bot"}]}'
print(troupe.Simulation.from_text(world, "w.json").options["simd"])
"""


def run(simd):
    return subprocess.run([sys.executable, "-c", SHOW], env={**os.environ, "TROUPE_SIMD": simd}, capture_output=True,
                          text=True)


class SimdOfTheEnvironment(unittest.TestCase):
    def test_is_used(self):
        done = run("scalar")
        self.assertEqual((done.returncode, done.stdout), (0, "scalar\n"), done.stderr)
        self.assertNotEqual(run("").stdout, "")

    def test_is_refused_where_kernels_cannot_run_on_it(self):
        done = run("avx9")
        self.assertEqual(done.returncode, 1)
        self.assertIn('ImportError: TROUPE_SIMD: error: "avx9" is not an instruction set that this program is compiled for; '
                      "this processor can use ", done.stderr)


if __name__ == "__main__":
    unittest.main()
