"""Tests of films, replay pages and pictures in notebooks: Simulation.film(), replay(), show() and _repr_html_()."""

import base64
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

import numpy as np
import troupe
from support import ROOM, InAFolder

PROGRAM = pathlib.Path(os.environ["PYTHONPATH"].split(":")[0]).parents[2] / "bin" / "troupe"
SIZE = (320, 240)


def moving():
    """Returns a simulation of a room with driving robots, with one thread, because the tests are short."""
    simulation = troupe.Simulation(ROOM, threads=1)
    simulation.swarm("r").set_speeds(0.4, 0.2)
    return simulation


@unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed")
class Film(InAFolder):
    def frames(self, file):
        command = ["ffmpeg", "-loglevel", "error", "-i", file, "-f", "rawvideo", "-pix_fmt", "rgb24", "-vsync", "0", "-"]
        raw = subprocess.run(command, check=True, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL).stdout
        return np.frombuffer(raw, np.uint8).reshape(-1, SIZE[1], SIZE[0], 3)

    def test_shows_the_run(self):
        simulation, other = moving(), moving()
        first = simulation.picture(*SIZE, camera="top")
        simulation.film("f.mp4", 4, *SIZE, speed=2, fps=10, camera="top")
        other.run_for(4)
        self.assertEqual(simulation.state_hash(), other.state_hash())
        frames = self.frames("f.mp4")
        self.assertEqual(len(frames), 21)  # at 0, 0.2, ..., 4 s
        last = simulation.picture(*SIZE, camera="top")
        moved = np.abs(first.astype(int) - last).max(axis=2) > 60  # pixels of the robots and of the clock
        difference = lambda frame, picture: np.abs(frame.astype(int) - picture)
        for frame, right, wrong in (frames[0], first, last), (frames[-1], last, first):
            self.assertLess(difference(frame, right).mean(), 4)  # the codec changes colours slightly
            self.assertLess(2 * difference(frame, right)[moved].mean(), difference(frame, wrong)[moved].mean())
        self.assertEqual(os.listdir(), ["f.mp4"])

    def test_poses_between_ticks_are_interpolated_and_layers_remember(self):
        simulation, other = moving(), moving()
        simulation.film("f.mp4", 0.4, *SIZE, fps=20, camera="top", layers="trails")
        frames = self.frames("f.mp4").astype(int)
        self.assertEqual(len(frames), 9)  # four per tick of 0.2 s
        for before, after in zip(frames, frames[1:]):
            self.assertGreater(np.abs(after - before).max(), 30)  # more than the noise of the codec
        other.run_for(0.4)
        without = other.picture(*SIZE, camera="top", layers="trails")  # one picture has no history
        self.assertGreater((np.abs(frames[-1] - without).max(axis=2) > 60).sum(), 5)

    def test_of_less_than_a_frame_is_one_picture_a_tick(self):
        simulation = moving()
        simulation.film("f.mp4", 0.2, *SIZE, speed=1, fps=1)
        self.assertEqual((simulation.tick, len(self.frames("f.mp4"))), (1, 1))

    def test_errors_leave_no_file(self):
        simulation = moving()
        for arguments, error in {
            ("f.webm", 1): "the name of a film must end in .mp4, found 'f.webm'",
            ("f.mp4", 0): "seconds must be a finite number above 0, found 0",
            ("f.mp4", float("nan")): "seconds must be a finite number above 0, found nan",
            ("f.mp4", float("inf")): "seconds must be a finite number above 0, found inf",
            ("f.mp4", 1, 0): "width and height must be 1 or more",
        }.items():
            with self.assertRaisesRegex(ValueError, re.escape(error)):
                simulation.film(*arguments)
        with self.assertRaises(ValueError):
            simulation.film("f.mp4", 1, camera="sideways")
        for arguments, error in {
            ("f.mp4", "1"): "seconds: found '1': give a number",
            (None, 1): "file: found None: give a path",
        }.items():
            with self.assertRaisesRegex(TypeError, f"^{error}$"):
                simulation.film(*arguments)
        with self.assertRaisesRegex(ValueError, "found 'f.webm'"):
            simulation.film(b"f.webm", 1)
        with self.assertRaisesRegex(RuntimeError, "none/f.mp4: error: cannot be written"):
            simulation.film("none/f.mp4", 1)
        path = os.environ["PATH"]
        try:
            os.environ["PATH"] = "/nowhere"
            with self.assertRaisesRegex(RuntimeError, "ffmpeg is not installed"):
                simulation.film("f.mp4", 1)
        finally:
            os.environ["PATH"] = path
        self.assertEqual((simulation.tick, os.listdir()), (0, []))

    def test_an_exception_in_a_step_removes_the_film(self):
        simulation = moving()

        @simulation.on_tick
        def fail(_):
            raise ArithmeticError("enough")

        with self.assertRaisesRegex(ArithmeticError, "enough"):
            simulation.film("f.mp4", 1, *SIZE)
        self.assertEqual(os.listdir(), [])


class Replay(InAFolder):
    def test_is_the_page_of_the_program(self):
        simulation, other = moving(), moving()
        simulation.replay("a.html", 3, every_s=0.6, fields=["pose", "stall"])
        other.record("run.h5", fields=["pose", "stall"], every_s=0.6)
        other.run_for(3)
        other.stop_recording()
        subprocess.run([PROGRAM, "replay", "run.h5", "-o", "b.html"], check=True, stdout=subprocess.DEVNULL)
        page = pathlib.Path("a.html").read_text()
        self.assertNotIn("@RECORDING@", page)
        self.assertEqual(page, pathlib.Path("b.html").read_text())
        self.assertEqual(simulation.state_hash(), other.state_hash())

    def test_does_not_replace_a_file_unasked(self):
        simulation = moving()
        pathlib.Path("a.html").write_text("old")
        with self.assertRaisesRegex(FileExistsError, "a.html: the file exists; replace=True replaces it"):
            simulation.replay("a.html", 1)
        self.assertEqual((simulation.tick, pathlib.Path("a.html").read_text()), (0, "old"))
        simulation.replay("a.html", 1, replace=True)
        self.assertIn("<html", pathlib.Path("a.html").read_text())

    def test_an_exception_in_a_step_ends_the_recording(self):
        simulation = moving()

        @simulation.on_tick
        def fail(_):
            raise ArithmeticError("enough")

        with self.assertRaisesRegex(ArithmeticError, "enough"):
            simulation.replay("a.html", 1)
        simulation.on_tick(None)
        simulation.replay("a.html", 1)  # the first recording has ended
        self.assertEqual(os.listdir(), ["a.html"])

    def test_errors(self):
        simulation = moving()
        with self.assertRaisesRegex(RuntimeError, "none/a.html: error: cannot be written"):
            simulation.replay("none/a.html", 1)
        with self.assertRaisesRegex(ValueError, "seconds must be a finite number above 0, found -1"):
            simulation.replay("a.html", -1)
        with self.assertRaisesRegex(ValueError, "every_s must be a finite number of 0 or more, found -1"):
            simulation.replay("a.html", 1, every_s=-1)
        with self.assertRaisesRegex(TypeError, r"fields must be a list of names, as in \['pose'\], found 'pose'"):
            simulation.replay("a.html", 1, fields="pose")
        with self.assertRaisesRegex(ValueError, "the name of the page must end in .html, found a.json"):
            simulation.replay("a.json", 1, replace=True)
        with self.assertRaisesRegex(ValueError, '^a.html: error: unknown field "nonsense"'):
            simulation.replay("a.html", 1, fields=["nonsense"])
        for arguments, error in ((("a.html", "1"), "seconds: found '1': give a number"),
                                 (("a.html", 1, "1"), "every_s: found '1': give a number"),
                                 ((None, 1), "file: found None: give a path")):
            with self.assertRaisesRegex(TypeError, f"^{error}$"):
                simulation.replay(*arguments[:2], **{"every_s": every_s for every_s in arguments[2:]})
        self.assertEqual((simulation.tick, os.listdir()), (0, []))
        simulation.record("run.h5")
        with self.assertRaisesRegex(RuntimeError, "^a.html: this run is already being recorded; call stop_recording"):
            simulation.replay("a.html", 1)
        self.assertEqual((simulation.tick, os.listdir()), (0, ["run.h5"]))
        simulation.stop_recording()

    def test_fields_are_shown_in_addition_to_poses(self):
        simulation, other = moving(), moving()
        simulation.replay("a.html", 1, fields=["stall"])
        other.replay("b.html", 1, fields=["stall", "pose"])
        self.assertEqual(pathlib.Path("a.html").read_text(), pathlib.Path("b.html").read_text())


class Notebook(InAFolder):
    def test_shows_a_picture_and_a_line(self):
        simulation = moving()
        simulation.step(3)
        text = simulation._repr_html_()
        picture = base64.b64decode(re.search('src="data:image/png;base64,([^"]+)"', text)[1])
        simulation.snapshot("s.png", 640, 360)
        self.assertEqual(picture, pathlib.Path("s.png").read_bytes())
        self.assertTrue(picture.startswith(b"\x89PNG"))
        self.assertTrue(text.endswith(f"A room: 7 robots, 0.6 s, state {simulation.state_hash():016x}"), text[-80:])

    def test_says_why_there_is_no_picture(self):
        class broken(troupe.Controller):
            robots = "r"

            def decide(self, robots):
                raise ValueError("<mine>")

        simulation = troupe.Simulation(ROOM, threads=1, controllers=broken)
        with self.assertRaises(troupe.StepError):
            simulation.step()
        reason = "tick 1: a step, a birth or a reset failed and left an incomplete state: call reset() before anything else"
        self.assertEqual(simulation._repr_html_(), f"A simulation of which no picture can be drawn: {reason}")
        simulation.reset()
        self.assertIn("<img", simulation._repr_html_())

    def test_a_title_is_text(self):
        simulation = troupe.Simulation({**ROOM, "title": "<b>R & D</b>"}, threads=1)
        self.assertIn("<br>&lt;b&gt;R &amp; D&lt;/b&gt;: 7 robots", simulation._repr_html_())

    def test_show_opens_a_file_outside_of_notebooks(self):
        pathlib.Path("opened.sh").write_text('#!/bin/sh\necho "$1" > opened\n')
        os.chmod("opened.sh", 0o755)
        program = ("import json, troupe\n"
                   "print(troupe.Simulation(json.load(open('w.json')), threads=1).show(64, 48, camera='perspective'))")
        pathlib.Path("w.json").write_text(json.dumps(ROOM))
        environment = {**os.environ, "BROWSER": f"{self.folder}/opened.sh %s", "TMPDIR": str(self.folder)}
        told = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True, env=environment)
        file = pathlib.Path(told.stdout.strip())
        self.assertEqual(file.parent, self.folder)
        self.assertEqual(file.read_bytes()[:4], b"\x89PNG")
        self.assertEqual(pathlib.Path("opened").read_text().strip(), file.as_uri())

    def test_show_returns_an_image_in_a_notebook(self):
        try:
            from IPython.core.interactiveshell import InteractiveShell
            from IPython.display import Image
        except ImportError:
            self.skipTest("IPython is not installed")
        InteractiveShell.instance()
        try:
            simulation = moving()
            shown = simulation.show(64, 48, color_by="velocity.x")
            simulation.snapshot("s.png", 64, 48, color_by="velocity.x")
        finally:
            InteractiveShell.clear_instance()
        self.assertIsInstance(shown, Image)
        self.assertEqual(shown.data, pathlib.Path("s.png").read_bytes())


if __name__ == "__main__":
    unittest.main()
