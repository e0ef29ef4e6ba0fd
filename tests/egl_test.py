#!/usr/bin/env python3
"""Tests that pictures by EGL are those by OSMesa, byte by byte, and that no graphics card draws them.

    egl_test.py TROUPE LIBRARY

LIBRARY is tests/render/other_libraries.cpp, which hides OSMesa from the program.
"""

import os
import resource
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

WORLDS = Path(__file__).resolve().parent.parent / "worlds"
TROUPE, LIBRARY = None, None


class Pictures(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def draw(self, world="crowd.json", *arguments, egl=True, **variables):
        """Returns the picture that the program draws, or its error."""
        picture = self.folder / "p.png"
        picture.unlink(missing_ok=True)
        done = subprocess.run([TROUPE, "render", WORLDS / world, "-o", picture, "--threads", "2", *arguments], capture_output=True, text=True,
                              env={**os.environ, **({"LD_PRELOAD": LIBRARY} if egl else {}), **variables})
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return picture.read_bytes() if picture.exists() else done.stderr

    def test_are_those_by_osmesa(self):
        for world in ("cave-simple.json", "crowd.json", "perception.json"):
            for look in (("--camera", "top", "--size", "640x480"), ("--camera", "perspective", "--size", "1280x720")):
                with self.subTest(world, look=look):
                    arguments = ("--for", "2", "--layers", "trails,scans", *look)
                    expected = self.draw(world, *arguments, egl=False)
                    self.assertTrue(expected.startswith(b"\x89PNG"), expected)
                    self.assertEqual(self.draw(world, *arguments), expected)

    def test_are_not_drawn_by_a_graphics_card(self):
        expected = self.draw()
        self.assertTrue(expected.startswith(b"\x89PNG"), expected)
        # The program would end if it opened the display of the card.
        self.assertEqual(self.draw(FAKE_GPU="1"), expected)
        self.assertIn("cannot draw: the installed EGL has no software device of Mesa", self.draw(FAKE_GPU="only"))

    def test_need_memory_and_say_so(self):
        """With too little address space, Mesa would abort."""
        for megabytes in range(100, 460, 20):
            limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))
            done = subprocess.run([TROUPE, "render", WORLDS / "crowd.json", "-o", self.folder / "p.png", "--threads", "1"], text=True,
                                  capture_output=True, env={**os.environ, "LD_PRELOAD": LIBRARY}, preexec_fn=limit)
            self.assertIn(done.returncode, (0, 1), f"{megabytes} MB: {done.stderr}")
            self.assertEqual(done.stderr.startswith("troupe: error: "), done.returncode == 1, done.stderr)

    def test_are_not_drawn_by_a_driver_of_the_users_choice(self):
        expected = self.draw(egl=False)
        for name in ("GALLIUM_DRIVER", "MESA_LOADER_DRIVER_OVERRIDE"):
            for egl in (False, True):
                self.assertEqual(self.draw(egl=egl, **{name: "zink"}), expected)


if __name__ == "__main__":
    TROUPE, LIBRARY = sys.argv[1:3]
    del sys.argv[1:3]
    unittest.main()
