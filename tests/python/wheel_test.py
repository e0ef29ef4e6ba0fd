"""Tests the wheel that the build backend makes of this build, installed with pip in a temporary folder."""

import email
import importlib.util
import os
import pathlib
import subprocess
import sys
import unittest
import zipfile

import troupe
from support import HOSPITAL, ROOT, InAFolder

BUILD = pathlib.Path(troupe.__file__).parents[4]
spec = importlib.util.spec_from_file_location("build_backend", ROOT / "python" / "build_backend.py")
backend = importlib.util.module_from_spec(spec)
spec.loader.exec_module(backend)


class TheWheel(InAFolder):
    def test_installs_and_runs(self):
        name = backend.build_wheel(self.folder, {"build-dir": os.path.relpath(BUILD, ROOT)})
        self.assertRegex(name, rf"^troupe-{troupe.__version__}-cp3\d+-cp3\d+-linux_\w+\.whl$")
        with zipfile.ZipFile(name) as wheel:
            names = set(wheel.namelist())
            recorded = wheel.read(f"troupe-{troupe.__version__}.dist-info/RECORD").decode().splitlines()
            about = email.message_from_bytes(wheel.read(f"troupe-{troupe.__version__}.dist-info/METADATA"))
        self.assertEqual({line.split(",")[0] for line in recorded}, names)
        self.assertEqual((about["Name"], about["Version"]), ("troupe", troupe.__version__))
        for file in ("__init__.py", "math.py", "_core.pyi", "py.typed", "envs/__init__.py", "envs/vector.py", "envs/tasks.py"):
            self.assertIn(f"troupe/{file}", names)
        if importlib.util.find_spec("pip") is None:
            zipfile.ZipFile(name).extractall("site")
        else:
            pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--target", "site", name]
            subprocess.run(pip, check=True)
        code = ("import troupe; world = troupe.Simulation(%r, robots=10); world.step(3); "
                "print(troupe.__file__); print(world.state_hash())" % str(HOSPITAL))
        done = subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": str(self.folder / "site")},
                              stdout=subprocess.PIPE, text=True, check=True)
        where, state = done.stdout.split()
        self.assertTrue(where.startswith(str(self.folder)), where)
        world = troupe.Simulation(HOSPITAL, robots=10)
        world.step(3)
        self.assertEqual(int(state), world.state_hash())


if __name__ == "__main__":
    unittest.main()
