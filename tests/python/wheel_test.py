"""Tests what the wheel's metadata says of this build, and the functions that find the files of an installation. The wheel
itself is tested by `scripts/wheel --check` (wheel_check.py), which needs the network."""

import os
import pathlib
import re
import subprocess
import sys
import unittest

import troupe
from support import HOSPITAL, ROOT, InAFolder

PACKAGE = pathlib.Path(troupe.__file__).parent
PROJECT = (ROOT / "pyproject.toml").read_text()


def value(key):
    return re.search(rf"^{key} = (.*?)(?:  #.*)?$", PROJECT, re.M)[1].strip('"')


class TheProject(unittest.TestCase):
    def test_version_is_that_of_cmake(self):
        expression = value("regex").replace("\\\\", "\\")
        found = re.search(expression, (ROOT / value("input")).read_text())
        self.assertEqual(found["value"], troupe.__version__)

    def test_command(self):
        self.assertEqual(value("troupe"), "troupe.__main__:main")
        code = ("import os, sys; from troupe.__main__ import main; sys.argv = ['troupe', '--version']; code = main(); "
                "sys.stdout.flush(); print(os.environ['TROUPE_PYTHON'], code)")
        environment = {name: text for name, text in os.environ.items() if name != "TROUPE_PYTHON"}
        lines = subprocess.run([sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE, text=True,
                               check=True).stdout.splitlines()
        self.assertTrue(any(line.startswith(troupe.version_line()) for line in lines), lines)
        self.assertIn(f"{sys.executable} 0", lines)
        environment["TROUPE_PYTHON"] = "another"  # a choice of the user
        done = subprocess.run([sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE, text=True, check=True)
        self.assertIn("another 0", done.stdout)

    def test_headers_of_plug_ins(self):
        """All headers that a plug-in includes are in the wheel: those of the libraries in it, and those that
        cmake/TroupeWheel.cmake lists. The page about controllers names the headers that plug-ins include."""
        installed = (ROOT / "cmake" / "TroupeWheel.cmake").read_text()
        libraries = re.search(r"^install\(TARGETS (.*?) EXPORT", installed, re.M)[1].replace("troupe_", "").split()
        self.assertIn("engine", libraries)
        page = (ROOT / "docs" / "controllers.md").read_text()
        named = set(re.findall(r"#include <(\w+/.*?)>|\(\.\./((?:sensors|models)/.*?\.hpp)\)", page))
        included, new = set(), {"troupe/plugin.hpp", *("".join(pair) for pair in named)}
        while new:
            included |= new
            texts = [(ROOT / header).read_text() for header in new if (ROOT / header).exists()]  # version.hpp is generated
            new = {header for text in texts for header in re.findall(r'^#include "(.*?)"', text, re.M)} - included
        self.assertIn("troupe/plugin_library.hpp", included)
        for header in ("engine/rows/measured_world.hpp", "models/devices/gripper.hpp", "models/controllers/beams.hpp"):
            self.assertIn(header, included)
        folders = tuple(f"{folder}/" for folder in [*libraries, *re.findall(r"DIRECTORY \S+?/(models/\w+) ", installed)])
        self.assertEqual([header for header in sorted(included)
                          if not header.startswith(folders) and f"/{header}" not in installed], [])


class Folders(InAFolder):
    def test_of_the_build_tree(self):
        self.assertEqual(troupe.worlds_dir(), HOSPITAL.parent)
        self.assertEqual(troupe.cmake_dir(), PACKAGE.parents[3])

    def installed(self, *files):
        """Copies the package to a folder like that of a wheel, with these files in it."""
        for file in ("__init__.py", *files):
            path = self.folder / "troupe" / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("")
        (self.folder / "troupe" / "_files.py").write_text((PACKAGE / "_files.py").read_text())

    def call(self, function):
        code = f"import troupe._files as files\ntry: print(files.{function}())\nexcept FileNotFoundError as e: print(e)"
        return subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": str(self.folder)},
                              stdout=subprocess.PIPE, text=True, check=True).stdout.strip()

    def test_of_a_wheel(self):
        self.installed("lib/cmake/troupe/troupe-config.cmake", "share/troupe/worlds/hospital.json")
        self.assertEqual(self.call("cmake_dir"), f"{self.folder}/troupe/lib/cmake/troupe")
        self.assertEqual(self.call("worlds_dir"), f"{self.folder}/troupe/share/troupe/worlds")

    def test_of_neither(self):
        self.installed()
        self.assertRegex(self.call("cmake_dir"),
                         f"^this installation of troupe has no CMake package: there is no troupe-config.cmake in "
                         f"{self.folder}/troupe/lib/cmake/troupe; wheels, and the prefix of cmake --install, contain it$")
        self.assertRegex(self.call("worlds_dir"), "^this installation of troupe has no worlds: ")


if __name__ == "__main__":
    unittest.main()
