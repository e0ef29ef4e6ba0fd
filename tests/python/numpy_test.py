"""Tests of the errors of `import troupe`: without NumPy, with a NumPy whose arrays the pybind11 of the build cannot read,
and without the C++ part of the package."""

import os
import pathlib
import shutil
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

    def test_is_needed(self):
        done = subprocess.run([sys.executable, "-c", "import sys; sys.modules['numpy'] = None; import troupe"],
                              env={**os.environ, "PYTHONPATH": str(PACKAGE)}, capture_output=True, text=True)
        self.assertRegex(done.stderr.splitlines()[-1], "^ModuleNotFoundError: .*numpy.*: troupe needs NumPy [(]Debian")


class CxxPart(InAFolder):
    def error(self):
        done = subprocess.run([sys.executable, "-c", "import troupe"], env={**os.environ, "PYTHONPATH": str(self.folder)},
                              capture_output=True, text=True)
        return done.stderr.splitlines()[-1]

    def test_is_needed(self):
        shutil.copytree(PACKAGE / "troupe", "troupe", ignore=shutil.ignore_patterns("_core.*"))
        self.assertRegex(self.error(), r"^ModuleNotFoundError: No module named 'troupe\._core': the C\+\+ part of the package "
                                       "is not in this folder; build it")
        pathlib.Path("troupe/_core.cpython-35m-x86_64-linux-gnu.so").touch()
        version = f"{sys.version_info[0]}\\.{sys.version_info[1]}"
        self.assertRegex(self.error(), f"built for another Python than this one, which is Python {version}: found _core.cpython-35m-")


if __name__ == "__main__":
    unittest.main()
