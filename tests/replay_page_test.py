#!/usr/bin/env python3
"""Opens pages of `troupe replay` in a headless Chromium and operates them with mouse and keyboard.

    replay_page_test.py TROUPE [PICTURES]    PICTURES: folder for screenshots

Also checks, without a browser, that apps/replay_page/replay.html was built from the sources in its folder.
"""

import base64
import hashlib
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
import unittest
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from tests.support.chromium import Page, Picture, find  # noqa: E402

SKIPPED = 77  # ctest's SKIP_RETURN_CODE
TROUPE = None
PICTURES = None
PROGRAM = find()
SIZE = (1000, 625)  # CSS pixels; small, because graphics are drawn in software
MOST_SCRIPT_MS = 10  # time of the script for a picture with 10,000 robots

WORLD = {
    "troupe": 1, "title": "A page's test", "seed": 3,
    "types": {
        "runner": {"size_m": [0.5, 0.4, 0.3], "drive": {"kind": "diff", "velocity_max_x_mps": 1},
                   "controller": {"kind": "script", "legs": [{"until_s": 100, "forward_mps": 0.5}]}},
        "looker": {"size_m": [0.5, 0.4, 0.3], "drive": {"kind": "diff"},
                   "sensors": [{"name": "eye", "kind": "ranger",
                                "transducers": [{"range_max_m": 3, "samples": 9, "fov_deg": 180}]}]},
        "wall": {"size_m": [12, 0.2, 0.6]},
    },
    "models": [
        {"name": "red", "type": "runner", "color": [0.8, 0.1, 0.1], "pose": {"x_m": -4, "y_m": -1}},
        {"name": "blue", "type": "looker", "color": [0.1, 0.2, 0.8], "pose": {"x_m": 1, "y_m": 1.5, "heading_deg": 90}},
        {"name": "north", "type": "wall", "color": "gray40", "pose": {"y_m": 3}},
        {"name": "south", "type": "wall", "color": "gray40", "pose": {"y_m": -3}},
    ],
}


YARD = {
    "troupe": 1, "title": "Comings and goings", "bounds_m": [[-5, -5], [5, 5]],
    "types": {
        "crane": {"size_m": [0.6, 0.6, 0.3], "color": "gray40",
                  "devices": [{"name": "arm", "kind": "actuator", "pose": {"z_m": 0.3}, "type": "rotational", "max_position": 3,
                               "max_speed": 0.5, "color": [0.8, 0.1, 0.1],
                               "blocks": [{"points_m": [[0, -0.2], [2, -0.2], [2, 0.2], [0, 0.2]], "z_m": [0, 0.2]}]}],
                  "sensors": [{"name": "eye", "kind": "ranger", "on": "arm", "pose": {"x_m": 2, "z_m": 0.1},
                               "transducers": [{"range_max_m": 2, "samples": 5, "fov_deg": 60}]},
                              {"name": "sonar", "kind": "ranger", "active": False, "transducers": [{"range_max_m": 2}]}],
                  "controller": {"kind": "operate", "orders": [{"at_s": 1, "device": "arm", "order": "go_to", "value": 1.5708}]}},
        "door": {"size_m": [0.3, 0.3, 0.3], "color": "gold",
                 "devices": [{"name": "out", "kind": "spawner", "population": "walker", "every_s": 2, "pose": {"x_m": 0.5}}]},
        "guard": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"},
                  "sensors": [{"name": "eye", "kind": "ranger", "pose": {"z_m": 0.1},
                               "transducers": [{"range_max_m": 1, "samples": 5, "fov_deg": 60}]}]},
        "walker": {"size_m": [0.4, 0.4, 0.2], "color": [0.1, 0.2, 0.8], "drive": {"kind": "diff"},
                   "devices": [{"name": "pack", "kind": "power_pack", "capacity_kJ": 0.01, "mass_kg": 1, "when_empty": "die"}],
                   "controller": {"kind": "script", "legs": [{"until_s": 100, "forward_mps": 0.5}]}},
    },
    "models": [{"name": "crane", "type": "crane", "pose": {"x_m": -1, "y_m": 2}},
               {"name": "guard", "type": "guard", "pose": {"x_m": 3, "y_m": -3}},
               {"name": "door", "type": "door", "pose": {"x_m": -4, "y_m": -3}}],
    "populations": [{"name": "walker", "type": "walker", "count": 0, "reserve": 3,
                     "place": {"rule": "uniform", "region_m": [[-4, -2], [-3, -1]]}}],
}


def troupe(folder, *arguments):
    return subprocess.run([TROUPE, *map(str, arguments)], cwd=folder, check=True, capture_output=True, text=True).stdout


class TheBundle(unittest.TestCase):
    def test_is_of_these_sources(self):
        folder = ROOT / "apps" / "replay_page"
        names = ["build.mjs", "index.html", "live_index.html", "package-lock.json", "package.json", "style.css"]
        names += [f"src/{path.name}" for path in (folder / "src").iterdir()]
        digest = hashlib.sha256()
        for name in sorted(names):
            digest.update(f"{name}\n".encode() + (folder / name).read_bytes() + b"\n")
        for name in ("replay.html", "live.html"):
            bundle = (folder / name).read_text()
            self.assertIn(f"Sources: apps/replay_page, sha256 {digest.hexdigest()}\n", bundle,
                          "the sources have changed: scripts/replay-page makes the bundles")


class Unpacking(unittest.TestCase):
    """Tests src/recording.js without the rest of the page. Its clock is replaced by one on which each step takes 1 ms."""

    BLOCKS = 20
    FRAMES = 10  # per block
    ROBOTS = 4000

    def script(self):
        """Returns the address of a module with the class Recording."""
        folder = ROOT / "apps" / "replay_page" / "src"

        def address(text):
            return "data:text/javascript;base64," + base64.b64encode(text.encode()).decode()

        return address(re.sub(r'"\./(\w+\.js)"', lambda name: f'"{address((folder / name[1]).read_text())}"',
                              (folder / "recording.js").read_text()))

    def test_blocks_that_the_user_passes_over_are_not_waited_for(self):
        series = base64.b64encode(zlib.compress(b"\1" * (3 * self.ROBOTS * self.FRAMES))).decode()
        header = {"times_s": list(range(self.BLOCKS * self.FRAMES)), "block_frames": self.FRAMES, "fields": [],
                  "robots": {"id": list(range(self.ROBOTS)), "color": ["#000000"] * self.ROBOTS, "types": [[0, self.ROBOTS]]},
                  "types": [{"mobile": True}], "pose": {"step_m": 1, "turn": 2000, "has_z": False, "z_m": [0] * self.ROBOTS}}
        with tempfile.TemporaryDirectory() as name, Page(PROGRAM) as page:
            (Path(name) / "empty.html").write_text("<!doctype html><title>Unpacking</title>")
            page.open(Path(name) / "empty.html")
            pictures = page.run(f"""(async () => {{
              const {{ Recording }} = await import("{self.script()}");
              const stream = Uint8Array.from(atob("{series}"), (letter) => letter.charCodeAt(0));
              const recording = new Recording({{ header: {json.dumps(header)}, blocks: Array({self.BLOCKS}).fill([stream]) }});
              let now = 0;
              performance.now = () => now++;
              for (let block = 0; block < {self.BLOCKS}; block++) {{
                recording.poses(block * {self.FRAMES});
                recording.pump(0);
              }}
              while (recording.work.length < {self.BLOCKS}) await new Promise((done) => setTimeout(done, 1));
              let pictures = 1;
              for (; !recording.poses(recording.frames - 1); pictures++) recording.pump(2);
              return pictures;
            }})()""")
            self.assertEqual(page.problems, [])
        self.assertGreater(pictures, 1)
        self.assertLess(pictures, self.BLOCKS, "pictures until the frame is shown, with one step for each picture")


class Used(unittest.TestCase):
    """Tests of one page, which is opened once, in its own browser."""

    options = ["--record-fields", "pose,stall,ranges"]
    seconds = 10

    @classmethod
    def world(cls, folder):
        path = folder / "world.json"
        path.write_text(json.dumps(WORLD))
        return path

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.addClassCleanup(cls.temporary.cleanup)
        troupe(cls.folder, "run", cls.world(cls.folder), "--quiet", "--for", cls.seconds, "--record", "run.h5", *cls.options)
        cls.told = troupe(cls.folder, "replay", "run.h5", "-o", "page.html")
        cls.page = Page(PROGRAM, SIZE)
        cls.addClassCleanup(cls.page.__exit__)
        cls.page.open(cls.folder / "page.html")
        cls.page.wait("window.troupe && troupe.state().shown")

    def tearDown(self):
        self.assertEqual(self.page.problems, [])

    def state(self):
        return self.page.run("(({scriptMs, ...rest}) => rest)(troupe.state())")

    def seek(self, time_s):
        self.page.run(f"troupe.play(false), troupe.seek({time_s})")
        self.shown()

    def frames(self, count):
        """Waits for `count` pictures, at most one second for each, because a busy Chromium may skip pictures."""
        self.page.run(f"(async () => {{ for (let i = 0; i < {count}; i++) await new Promise(done => {{ "
                      "requestAnimationFrame(done); setTimeout(done, 1000); }); })()")

    def shown(self):
        """Waits until the screen shows the requested state."""
        self.frames(2)
        self.page.wait("troupe.state().shown")

    def keep(self, name):
        """Saves a screenshot in the folder PICTURES, if it is given."""
        if PICTURES:
            (PICTURES / f"{name}.png").write_bytes(self.page.screenshot())

    def box(self, x0, y0, x1, y1):
        """Returns a screenshot of a part of the screen. (A screenshot of the whole screen takes seconds to decode.)"""
        return Picture(self.page.screenshot((x0, y0, x1, y1)))

    def pixel(self, place):
        x, y = int(place[0]), int(place[1])
        return self.box(x, y, x + 1, y + 1).at(0, 0)

    def place(self, name):
        return self.page.run(f"troupe.screenPlace({json.dumps(name)})")

    def spot(self, name):
        """Returns the screen position of a point on top of a robot, next to the mark at its front."""
        return self.page.run(f"troupe.screenPlace({json.dumps(name)}, [-0.12, -0.12, 0.3])")

    def wait_for_text(self, selector, pattern):
        """Waits until the text of an element matches; the panel decodes the readings of a sensor before it shows them."""
        self.page.wait(f"new RegExp({json.dumps(pattern)}).test(document.querySelector({json.dumps(selector)}).innerText)")

    def text(self, selector):
        return self.page.run(f"document.querySelector({json.dumps(selector)}).innerText")


class APage(Used):
    def setUp(self):
        self.page.run("troupe.select(null), troupe.color('own colours'), troupe.trails(0), troupe.theme('light')")
        self.seek(2)

    def test_says_what_it_shows(self):
        self.assertRegex(self.told, r"page.html: 2 robots, 101 frames every 0.1 s, 0\.\d MB\n")
        self.assertEqual(self.text("h1"), "A page's test")
        self.assertEqual(self.text("#about p"), "2 robots, seed 3")
        self.assertEqual(self.text("#time"), "0:02.0")
        self.assertEqual(self.text("#end"), "0:10.0")
        self.assertEqual(self.page.run("document.getElementById('time').ariaLive"), "off")  # not read while it runs
        self.assertIn("A page's test", self.page.run("document.title"))

    def test_robots_are_where_they_were(self):
        x2, y2, z2, heading2 = self.page.run("troupe.pose('red')")
        self.seek(6)
        x6, y6, _, _ = self.page.run("troupe.pose('red')")
        self.assertAlmostEqual(x6 - x2, 2, delta=0.002)
        self.assertAlmostEqual(y2, -1, delta=0.001)
        self.assertAlmostEqual(y6, -1, delta=0.001)
        self.assertEqual((z2, heading2), (0, 0))
        self.seek(6.05)  # between two frames
        self.assertAlmostEqual(self.page.run("troupe.pose('red')")[0] - x6, 0.025, delta=0.001)

    def test_plays_and_pauses_by_key_and_button(self):
        self.page.press(" ", "Space")
        self.page.wait("troupe.state().time > 2.5")
        self.assertTrue(self.state()["playing"])
        self.page.click(*self.center("#play"))
        self.shown()
        stopped = self.state()["time"]
        time.sleep(0.3)
        self.assertEqual(self.state()["time"], stopped)
        self.page.run("troupe.setSpeed(100), troupe.play()")
        self.page.wait("!troupe.state().playing")
        self.assertEqual(self.state()["time"], 10)
        self.page.run("troupe.setSpeed(1), troupe.play()")
        self.page.wait("troupe.state().time < 5")  # from the start again

    def center(self, selector):
        box = self.page.run(f"(({{x, y, width, height}}) => [x, y, width, height])"
                            f"(document.querySelector({json.dumps(selector)}).getBoundingClientRect())")
        return box[0] + box[2] / 2, box[1] + box[3] / 2

    def test_the_space_bar_operates_the_control_with_the_focus(self):
        self.page.click(*self.center("#slant"))
        self.shown()
        self.page.press(" ", "Space")  # after a click with the mouse, the space bar plays and pauses
        self.shown()
        self.assertEqual((self.text("#slant"), self.state()["playing"]), ("top", True))
        self.page.press(" ", "Space")
        self.page.run("document.activeElement.blur()")
        self.page.press("Tab")  # the user now uses the keyboard
        self.page.run("document.getElementById('slant').focus()")
        self.page.press(" ", "Space")
        self.shown()
        self.assertEqual((self.text("#slant"), self.state()["playing"]), ("3D", False))

    def test_scrubs(self):
        self.page.click(*self.center("#scrub"))
        self.shown()
        self.assertAlmostEqual(self.state()["time"], 5, delta=0.2)
        self.page.press("ArrowLeft")
        self.assertAlmostEqual(self.state()["time"], 4, delta=0.2)
        self.page.press("Home")
        self.assertEqual(self.state()["time"], 0)
        self.page.press("End")
        self.assertEqual(self.state()["time"], 10)
        self.page.press(",", "Comma")
        self.assertAlmostEqual(self.state()["time"], 9.9, delta=1e-6)
        self.page.press("+")
        self.assertEqual(self.state()["speed"], 2)
        self.page.press("-")
        self.assertEqual(self.state()["speed"], 1)

    def test_a_key_that_is_held_switches_once(self):
        def hold(key, code):
            for repeat in (False, True):
                self.page.call("Input.dispatchKeyEvent", type="keyDown", key=key, code=code, text="", autoRepeat=repeat)
            self.page.call("Input.dispatchKeyEvent", type="keyUp", key=key, code=code)

        self.seek(5)
        hold("v", "KeyV")
        self.shown()
        self.assertEqual(self.text("#slant"), "top")
        hold("V", "KeyV")
        self.shown()
        self.assertEqual(self.text("#slant"), "3D")
        hold("ArrowLeft", "ArrowLeft")
        self.assertEqual(self.state()["time"], 3)

    def test_robots_and_walls_are_drawn(self):
        self.keep("above")
        at = self.spot("red")
        self.assertEqual(self.pixel(at), (204, 26, 26))
        self.assertEqual(self.pixel(self.spot("blue")), (26, 51, 204))
        wall = self.page.run("troupe.screenPlace('red', [0, 4, 0.6])")
        self.assertEqual(self.pixel(wall), (102, 102, 102))  # gray40
        self.seek(8)
        self.assertGreater(min(self.pixel(at)), 200, "it has gone from there")

    def test_a_click_selects(self):
        self.page.click(*self.place("blue"))
        self.shown()
        self.assertEqual(self.state()["selected"], "blue")
        self.assertEqual(self.text("#panel h2"), "blue")
        self.wait_for_text("#panel", r"ranges\s+1\.400 to 3\.000 m")
        self.wait_for_text("#panel", r"stalled\s+0")
        panel = self.text("#panel")
        self.assertIn("id 2, looker", panel)
        self.assertRegex(panel, r"x\s+1\.000 m")
        self.assertRegex(panel, r"heading\s+90\.\d °")
        self.shown()
        self.keep("selected")
        self.page.press("Escape")
        self.assertIsNone(self.state()["selected"])
        self.assertTrue(self.page.run("document.getElementById('panel').hidden"))
        self.page.click(*self.page.run("troupe.screenPlace('red', [4, 0, 0])"))  # no robot is there
        self.assertIsNone(self.state()["selected"])

    def test_colour_by_field(self):
        self.assertEqual(self.page.run("troupe.colors()"),
                         ["own colours", "speed", "minimum of eye.ranges (looker)", "stall.stalled"])
        at = self.spot("red")
        self.page.run("troupe.color('speed')")
        self.shown()
        self.assertEqual(self.pixel(at), (173, 220, 48), "none is faster")
        self.assertEqual(self.pixel(self.spot("blue")), (68, 1, 84), "none is slower")
        self.assertIn("speed, m/s", self.text("#legend"))
        self.assertIn("0.50", self.text("#legend"))
        self.page.run("troupe.color('minimum of eye.ranges (looker)')")
        self.page.wait("troupe.state().coloured")
        self.shown()
        self.assertEqual(self.pixel(at), (176, 170, 158), "it has no such sensor")
        self.page.press("c", "KeyC")
        self.shown()
        self.assertIn("stalled", self.text("#legend"))

    def test_trails(self):
        self.seek(8)
        x, y = map(int, self.place("red"))
        behind, ahead = (x - 90, y - 4, x - 35, y + 5), (x + 35, y - 4, x + 90, y + 5)
        before = self.box(*behind), self.box(*ahead)
        self.page.run("troupe.trails(5)")
        for _ in range(10):  # each picture adds only a few marks
            self.shown()
        self.keep("trails")
        self.assertGreater(self.box(*behind).different(before[0]), 40)
        self.assertEqual(self.box(*ahead).different(before[1]), 0)

    def test_pans_zooms_and_turns(self):
        place = "troupe.screenPlace('blue')"
        x, y = self.page.run(place)
        self.page.drag((500, 320), (400, 280))
        self.settle()
        moved = self.page.run(place)
        self.assertAlmostEqual(moved[0] - x, -100, delta=12)
        self.assertAlmostEqual(moved[1] - y, -40, delta=12)
        red = self.page.run("troupe.screenPlace('red')")
        apart = red[0] - moved[0]
        self.page.mouse("mouseWheel", 500, 320, deltaX=0, deltaY=-240)
        self.settle()
        nearer = self.page.run("troupe.screenPlace('red')")[0] - self.page.run(place)[0]
        self.assertGreater(nearer / apart, 1.1)
        self.page.press("v", "KeyV")
        self.settle()
        self.keep("slanted")
        self.assertEqual(self.text("#slant"), "top")
        before = self.page.run(place)
        self.page.drag((500, 320), (600, 320), button="right")
        self.settle()
        self.assertNotAlmostEqual(self.page.run(place)[0], before[0], delta=3)
        self.page.press("v", "KeyV")
        self.settle()
        back = self.page.run(place)
        self.assertAlmostEqual(back[0], x, delta=1)
        self.assertAlmostEqual(back[1], y, delta=1)

    def settle(self):
        """Waits until the camera, which slows down smoothly, has stopped."""
        self.frames(40)

    def test_is_dark_where_it_is_dark(self):
        empty = self.page.run("troupe.screenPlace('blue', [-3, 0, 0])")
        light = self.pixel(empty)
        self.page.press("d", "KeyD")
        self.shown()
        self.keep("dark")
        self.assertGreater(min(light), 200)
        self.assertLess(max(self.pixel(empty)), 60)
        self.assertEqual(self.pixel(self.spot("red"))[0] > 150, True)
        for theme in ("dark", "light"):  # the page follows the setting of the browser
            self.page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
            self.shown()
        self.page.wait("document.documentElement.dataset.theme === 'light'")
        self.shown()
        self.assertEqual(self.pixel(empty), light)

    def test_shows_its_keys(self):
        self.page.press("?", "Slash", shift=True)
        self.assertTrue(self.page.run("document.getElementById('keys').open"))
        self.assertIn("play or pause", self.text("#keys"))
        self.page.run("document.getElementById('keys').close()")


class PartsThatMove(Used):
    options = ["--record-fields", "pose,ranges,stall"]
    seconds = 8

    @classmethod
    def world(cls, folder):
        path = folder / "yard.json"
        path.write_text(json.dumps(YARD))
        return path

    def arm(self, angle):
        """Returns the screen position of a point on the arm after the arm has turned by `angle`."""
        return self.page.run(f"troupe.screenPlace('crane', [{1.5 * math.cos(angle)}, {1.5 * math.sin(angle)}, 0.5])")

    def test_an_arm_turns(self):
        self.assertNotIn("at rest", self.told)
        self.seek(0.5)
        ahead, left = self.arm(0), self.arm(math.pi / 2)
        self.assertEqual(self.pixel(ahead), (204, 26, 26))
        self.assertGreater(min(self.pixel(left)), 200)
        self.seek(2.05)  # between two frames: it began at 1.1 s
        x, y = self.arm(0.5 * 0.95)
        self.assertEqual(self.pixel((x, y)), (204, 26, 26))
        self.seek(6)
        self.keep("arm")
        self.assertGreater(min(self.pixel(ahead)), 200)
        self.assertEqual(self.pixel(left), (204, 26, 26))

    def test_what_stands_on_it_looks_from_there(self):
        self.seek(6)
        beam = self.page.run("troupe.screenPlace('crane', [0, 2.8, 0.4])")  # straight ahead of the sensor, in open space
        before = self.pixel(beam)
        self.page.run("troupe.select('crane')")
        self.wait_for_text("#panel", r"ranges")
        self.wait_for_text("#panel", r"sonar\s+ranges\s+no reading")  # because it does not run
        self.shown()
        self.page.wait("troupe.state().scanned")
        self.shown()
        self.keep("arm_sees")
        self.assertNotEqual(self.pixel(beam), before)
        self.page.run("troupe.select(null)")

    def test_readings_are_those_of_the_type_of_the_robot(self):
        self.seek(6)
        beam = self.page.run("troupe.screenPlace('guard', [0.6, 0, 0.1])")  # "eye" is also a ranger of the type crane
        before = self.pixel(beam)
        self.page.run("troupe.select('guard')")
        self.page.wait("troupe.state().scanned")
        self.shown()
        self.keep("guard_sees")
        self.assertNotEqual(self.pixel(beam), before)
        self.page.run("troupe.select('door')")
        self.shown()
        self.assertFalse(self.state()["scanned"], "it has no ranger")
        self.page.run("troupe.select(null)")

    def test_who_is_born_comes_and_who_dies_goes(self):
        self.seek(0)
        self.assertEqual(self.text("#about p"), "1 of 4 robots and 2 other bodies, seed 1")
        self.page.run("troupe.select('walker0')")
        self.shown()
        self.assertRegex(self.text("#panel"), r"x\s+not in the world")
        self.assertRegex(self.text("#panel"), r"stalled\s+–")
        self.seek(3.5)
        self.assertEqual(self.text("#about p"), "2 of 4 robots and 2 other bodies, seed 1")
        self.assertRegex(self.text("#panel"), r"x\s+-?[0-9.]+ m")
        self.assertEqual(self.pixel(self.spot("walker0")), (26, 51, 204))
        self.keep("born")
        self.seek(8)
        self.assertRegex(self.text("#panel"), r"x\s+not in the world")
        self.page.run("troupe.select(null)")


class ShownColors(Used):
    """LEDs and painted zones are drawn in their recorded colours, whatever the colours in the world file are."""

    options = []  # additional options of `troupe run`; none: the default fields are recorded
    seconds = 1

    @classmethod
    def world(cls, folder):
        lamp = {"name": "lamp", "kind": "led", "shows": [0, 0.6, 0.2]}
        types = {"lit": {**WORLD["types"]["runner"], "devices": [lamp]}, "plain": WORLD["types"]["runner"],
                 "zone": {"size_m": [1, 1, 0.01], "obstacle": False, "ranger_return": -1, "devices": [{**lamp, "shows": [1, 0.8, 0]}]}}
        types["mast"] = {"size_m": [1, 1, 0.2], "drive": {"kind": "diff"},
                         "parts": [{"name": "top", "size_m": [0.5, 0.5, 0.1], "color": "gold", "pose": {"z_m": 0.2}, "devices": [lamp]}]}
        types["crane"] = {"size_m": [0.6, 0.6, 0.3],
                          "devices": [YARD["types"]["crane"]["devices"][0], {**lamp, "on": "arm", "shows": [0.8, 0, 0.6]}]}
        models = [{"name": name, "type": name, "color": [0.1, 0.2, 0.8], "pose": {"x_m": x, "y_m": y}}
                  for name, x, y in (("lit", 0, -2), ("plain", 0, 0), ("zone", 0, 2), ("mast", -3, 0), ("crane", -4, 2))]
        path = folder / "lamps.json"
        path.write_text(json.dumps({"troupe": 1, "types": types, "models": models}))
        return path

    def test_own_colours_are_those_that_are_shown(self):
        self.seek(0.5)
        self.keep("shown_colors")
        self.assertEqual(self.pixel(self.spot("lit")), (0, 153, 51))
        self.assertEqual(self.pixel(self.spot("plain")), (26, 51, 204))
        self.assertEqual(self.pixel(self.spot("zone")), (255, 204, 0))
        self.page.run("troupe.color('speed')")  # a field that zones do not have
        self.page.wait("troupe.state().coloured")
        self.shown()
        self.assertEqual(self.pixel(self.spot("zone")), (255, 204, 0))
        self.assertNotEqual(self.pixel(self.spot("lit")), (0, 153, 51))
        self.page.run("troupe.color('own colours')")

    def test_parts_have_the_colours_that_they_show(self):
        self.seek(0.5)
        self.keep("shown_colors_of_parts")

        def at(name, x, y, z):
            return self.pixel(self.page.run(f"troupe.screenPlace('{name}', [{x}, {y}, {z}])"))

        self.assertEqual(at("mast", -0.4, -0.4, 0.2), (26, 51, 204))
        self.assertEqual(at("mast", -0.12, -0.12, 0.3), (0, 153, 51))
        self.assertEqual(at("mast", 0.17, 0, 0.3), (255, 255, 255), "the mark is on top of the part")
        self.assertEqual(at("crane", 1.5, 0, 0.5), (204, 0, 153), "a joint moves the part")
        self.page.run("troupe.color('speed')")
        self.page.wait("troupe.state().coloured")
        self.shown()
        self.assertNotEqual(at("mast", -0.4, -0.4, 0.2), (26, 51, 204))
        self.assertEqual(at("mast", -0.12, -0.12, 0.3), (0, 153, 51))
        self.page.run("troupe.color('own colours')")


class TenThousandRobots(Used):
    options = ["--record-fields", "pose,stall"]
    seconds = 2

    @classmethod
    def world(cls, folder):
        return ROOT / "worlds" / "hospital-10cm.json"

    def test_the_page_plays(self):
        self.assertEqual(self.state()["robots"], 10000)
        self.page.run("troupe.color('speed'), troupe.trails(2), troupe.setSpeed(0.25), troupe.seek(0), troupe.play()")
        self.page.wait("troupe.state().time > 0.2")
        self.page.run("troupe.play(false), troupe.seek(1.5)")
        self.shown()
        self.keep("ten_thousand")

    @unittest.skipUnless(os.environ.get("TROUPE_TIMED"), "its time depends on the machine: TROUPE_TIMED=1 measures it")
    def test_script_takes_less_than_10_ms_a_picture(self):
        self.page.run("troupe.color('speed'), troupe.trails(2), troupe.setSpeed(0.25)")
        median = float("inf")
        for attempt in range(3):  # the machine may be busy with something else
            self.page.run("troupe.seek(0), troupe.play(), troupe.state().scriptMs.length")
            self.frames(40)
            times = self.page.run("troupe.state().scriptMs.slice(-30)")
            if len(times) < 30:
                continue  # too few pictures for a median
            median = statistics.median(times)
            print(f"10,000 robots: script takes {median:.2f} ms a picture, at most {max(times):.2f}")
            if median < MOST_SCRIPT_MS:
                break
        self.assertLess(median, MOST_SCRIPT_MS)


class ADamagedPage(unittest.TestCase):
    def test_says_so(self):
        with tempfile.TemporaryDirectory() as name, Page(PROGRAM) as page:
            folder = Path(name)
            (folder / "w.json").write_text(json.dumps(WORLD))
            troupe(folder, "run", "w.json", "--quiet", "--for", 1, "--record", "run.h5")
            troupe(folder, "replay", "run.h5", "-o", "page.html")
            whole = (folder / "page.html").read_text()
            cut = re.sub(r'(id="recording" type="text/plain">[^<]*)[^<]{400}</script>', r"\1</script>", whole)
            self.assertNotEqual(cut, whole)
            (folder / "cut.html").write_text(cut)
            page.open(folder / "cut.html")
            page.wait("document.getElementById('problem')?.innerText.startsWith('This page cannot be shown')")
            self.assertEqual(page.run("document.getElementById('problem').getAttribute('role')"), "alert")


class APageOfOneFrame(unittest.TestCase):
    def test_its_robots_have_no_speed(self):
        with tempfile.TemporaryDirectory() as name, Page(PROGRAM) as page:
            folder = Path(name)
            (folder / "w.json").write_text(json.dumps(WORLD))
            troupe(folder, "run", "w.json", "--quiet", "--for", 0, "--record", "run.h5")
            troupe(folder, "replay", "run.h5", "-o", "page.html")
            page.open(folder / "page.html")
            page.wait("window.troupe && troupe.state().shown")
            self.assertEqual(page.run("troupe.state().frames"), 1)
            page.run("troupe.color('speed')")
            page.wait("troupe.state().coloured || !document.getElementById('problem').hidden", 30)
            self.assertTrue(page.run("document.getElementById('problem').hidden"), page.problems)
            self.assertEqual(page.problems, [])


class APageWithAnError(unittest.TestCase):
    def test_says_so_and_goes_on(self):
        with tempfile.TemporaryDirectory() as name, Page(PROGRAM) as page:
            folder = Path(name)
            (folder / "w.json").write_text(json.dumps(WORLD))
            troupe(folder, "run", "w.json", "--quiet", "--for", 2, "--record", "run.h5")
            troupe(folder, "replay", "run.h5", "-o", "page.html")
            page.open(folder / "page.html")
            page.wait("window.troupe && troupe.state().shown")
            page.run("document.getElementById('time').remove(), troupe.setSpeed(0.1), troupe.play()")
            page.wait("!document.getElementById('problem').hidden")
            self.assertIn("Error in this page", page.run("document.getElementById('problem').innerText"))
            frame = page.run("troupe.state().frame")
            page.wait(f"troupe.state().frame > {frame + 2}")
            self.assertEqual(len(page.problems), 1, page.problems)


if __name__ == "__main__":
    TROUPE = str(Path(sys.argv.pop(1)).resolve())
    if len(sys.argv) > 1:
        PICTURES = Path(sys.argv.pop(1)).resolve()
        PICTURES.mkdir(parents=True, exist_ok=True)
    if PROGRAM is None:
        suite = unittest.defaultTestLoader.loadTestsFromTestCase(TheBundle)
        if not unittest.TextTestRunner().run(suite).wasSuccessful():
            sys.exit(1)
        print("SKIPPED: no Chromium (scripts/setup --checks installs it): the replay page was not tested")
        sys.exit(SKIPPED)
    unittest.main()
