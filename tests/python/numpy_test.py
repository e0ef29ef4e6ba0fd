"""Tests that the package refuses a NumPy whose arrays the pybind11 of the build cannot read."""

import os
import pathlib
import subprocess
import sys
import unittest

import troupe
from support import InAFolder

PACKAGE = pathlib.Path(troupe.__file__).absolute().parents[1]


class NumPy(InAFolder):
    def test_2_is_refused_by_a_build_for_1(self):
        if not troupe._core.needs_numpy_1:
            self.skipTest("built with a pybind11 that knows NumPy 2")
        (self.folder / "numpy.py").write_text('__version__ = "2.1.0"\n')
        path = os.pathsep.join([str(self.folder), str(PACKAGE)])
        done = subprocess.run([sys.executable, "-c", "import troupe"], env={**os.environ, "PYTHONPATH": path},
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r'ImportError: troupe was built with pybind11 2\.\d+, which needs NumPy 1, but NumPy '
                                      r'2\.1\.0 is installed: pip install "numpy<2"')


if __name__ == "__main__":
    unittest.main()
