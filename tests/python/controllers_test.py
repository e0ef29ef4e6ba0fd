"""Tests of controllers and measures in Python: run, check, sweep, checkpoints, and errors."""

import functools
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import traceback
import unittest
from unittest import mock

import numpy as np
import troupe
from support import InAFolder, is_lacking, variables_of_locale

PACKAGES = pathlib.Path(os.environ["PYTHONPATH"].split(":")[0])
PROGRAM = PACKAGES.parents[2] / "bin" / "troupe"
PLUGINS = PACKAGES.parents[2] / "plugins" / "plugins"

WORLD = """{"troupe": 1, "quit_time_s": 2, "measures": ["stalls"],
  "arena": {"size_m": [6, 6]},
  "types": {"bot": {"disc": {"radius_m": 0.1, "height_m": 0.2}, "drive": {"kind": "diff"},
    "sensors": [{"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2, "fov_deg": 180, "samples": 5}]},
                {"name": "radio", "kind": "radio", "range_m": 2, "payload": 4, "most_heard": 4}],
    "devices": [{"name": "lamp", "kind": "led"}]}},
  "populations": [{"name": "r", "type": "bot", "count": 30, "place": {"rule": "uniform"}}]}"""

# Each robot changes its turn rate at random and keeps it in its memory. It shows near obstacles with its LED, and sends the
# turn rate by radio.
ROAM = """import numpy as np
import troupe


class roam(troupe.Controller):
    \"\"\"roam about\"\"\"

    robots = "r"
    memory = {"turn": np.float32(0.25), "steps": "u4", "seen": np.zeros(5, "f4")}

    def decide(self, robots):
        memory = robots.memory
        memory["turn"] = 0.9 * memory["turn"] + 0.1 * robots.normal()
        memory["steps"] += 1
        memory["seen"] = robots.ranges("eye")
        near = memory["seen"].min(axis=1) < 0.4
        robots.set_speeds(np.where(near, 0.0, 0.3), memory["turn"] + near)
        robots.command("lamp", shows=1, red=near)
        robots.say(memory["turn"])
        heard, there = robots.heard("f4")
        robots.command("lamp", green=there.any(axis=1), where=near)


@troupe.measure(unit="m")
def reach(robots):
    "largest distance from the middle"
    return np.abs(robots.poses()[:, :2]).max()
"""

# The same rule as in the plug-in tests/plugins/walker.cpp.
WALKER = """import numpy as np
import troupe


class walker(troupe.Controller):
    memory = {"phase": "f8", "faint": "f8", "steps": "u4"}

    def decide(self, robots):
        memory = robots.memory
        memory["phase"] += 0.3 * robots.normal()
        memory["faint"] = 0.5 * (memory["faint"] + 2.0**-1050 * robots.uniform())
        memory["steps"] += 1
        robots.set_speeds(0.3 * troupe.math.cos(memory["phase"]), troupe.math.sin(memory["phase"]))
"""


class Controllers(InAFolder):
    def setUp(self):
        super().setUp()
        self.write("w.json", WORLD)
        self.write("roam.py", ROAM)

    def write(self, name, text):
        (self.folder / name).write_text(text)

    def troupe(self, *arguments, code=0, **environment):
        made = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=300,
                              env={**os.environ, "TROUPE_PYTHON": sys.executable, **environment})
        self.assertEqual(made.returncode, code, made.stdout + made.stderr)
        return made

    def hashes(self, log):
        return [line.split()[:2] for line in (self.folder / log).read_text(errors="replace").splitlines() if not line.startswith("#")]

    def test_the_only_radio_needs_no_name(self):
        heard = []

        class Talk(troupe.Controller):
            def decide(self, robots):
                robots.say(b"ab")
                heard.append(robots.heard("S2")[1].sum())

        world = troupe.Simulation(json.loads(WORLD.replace('"name": "radio"', '"name": "ear"')), controllers=Talk)
        world.step(3)
        self.assertGreater(heard[-1], 0)

    def test_a_run_a_simulation_and_a_resumed_run_have_one_hash(self):
        self.troupe("run", "w.json", "--controller", "roam.py", "--hash-log", "run.log")
        hashes = self.hashes("run.log")
        self.assertEqual(len(hashes), 21)
        world = troupe.Simulation("w.json", controllers=["roam.py"], threads=3, tile_size_m=1)
        for tick, expected in hashes[1:]:
            world.step()
            self.assertEqual((tick, expected), (str(world.tick), f"{world.state_hash():016x}"))
        memory = world.table("roam/0")
        self.assertEqual(memory["steps"].tolist(), [20] * 30)
        self.assertEqual([field.name for field in memory.fields], ["turn", "steps", "seen"])
        self.assertGreater(np.ptp(memory["turn"]), 0)
        self.assertTrue((world.swarm().readings("shown_color", "lamp")[:, 0] > 0).any())

        self.troupe("run", "w.json", "--controller", "roam.py", "--for", "0.7", "--checkpoint", "c.h5")
        self.troupe("resume", "c.h5", "--controller", "roam.py", "--for", "2", "--hash-log", "rest.log")
        self.assertEqual(self.hashes("rest.log")[-1], hashes[-1])
        again = troupe.Simulation.resume("c.h5", controllers=["roam.py"])
        again.step(13)
        self.assertEqual(f"{again.state_hash():016x}", hashes[-1][1])
        world.reset()
        world.step(20)
        self.assertEqual(f"{world.state_hash():016x}", hashes[-1][1])

    def test_ranks_of_one_process_have_the_same_hash(self):
        self.troupe("run", "w.json", "--controller", "roam.py", "--hash-log", "one.log")
        self.troupe("run", "w.json", "--controller", "roam.py", "--ranks", "3", "--hash-log", "three.log")
        self.assertEqual(self.hashes("three.log"), self.hashes("one.log"))
        made = self.troupe("check", "w.json", "--controller", "roam.py", "--for", "1", "--ranks", "1,2,4")
        self.assertNotIn("DIFFERS", made.stdout)
        self.write("roam.py", ROAM.replace("        memory = robots.memory\n", "        memory = robots.nothing\n"))
        made = self.troupe("run", "w.json", "--controller", "roam.py", "--ranks", "3", code=1)
        self.assertIn("roam.py:", made.stderr)

    def test_a_checkpoint_needs_its_script(self):
        self.troupe("run", "w.json", "--controller", "roam.py", "--for", "0.5", "--checkpoint", "c.h5")
        self.assertIn("if it is a Python script, give --controller roam.py",
                      self.troupe("resume", "c.h5", "--for", "1", code=2).stderr)
        self.write("roam.py", ROAM.replace("0.9 *", "0.8 *"))
        self.assertIn("--across-plugins",
                      self.troupe("resume", "c.h5", "--controller", "roam.py", "--for", "1", code=2).stderr)
        self.troupe("resume", "c.h5", "--controller", "roam.py", "--for", "1", "--across-plugins")

    def test_check_finds_the_same_bits_and_a_state_that_is_not_declared(self):
        made = self.troupe("check", "w.json", "--controller", "roam.py", "--for", "1", "--threads", "1,3",
                           "--tile-size", "1,3", "--amnesia", "--controllers")
        self.assertNotIn("DIFFERS", made.stdout)
        self.assertIn("300 decisions, each made 3 times", made.stdout)
        self.write("leaky.py", ROAM.replace("class roam", "CALLS = [0]\n\n\nclass leaky").replace(
            "        memory = robots.memory\n",
            "        memory = robots.memory\n        CALLS[0] += 1\n        memory['turn'] += 1e-3 * CALLS[0]\n"))
        made = self.troupe("check", "w.json", "--controller", "leaky.py", "--for", "1", code=1)
        self.assertIn("DIFFERS", made.stdout)

    def test_the_law_of_a_plug_in_gives_its_hash(self):
        self.write("walker.py", WALKER)
        self.troupe("run", "w.json", "--controller", "walker.py", "--hash-log", "python.log")
        world = WORLD.replace('"devices"', '"controller": {"kind": "walker"}, "devices"')
        self.write("cpp.json", world)
        self.troupe("run", "cpp.json", "--plugin-path", PLUGINS, "--hash-log", "cpp.log")
        self.assertEqual(self.hashes("python.log"), self.hashes("cpp.log"))

    def test_measures_in_python(self):
        self.troupe("run", "w.json", "--controller", "roam.py", "--measures", "m.csv", "--measure", "roam:reach,stalls")
        lines = (self.folder / "m.csv").read_text().splitlines()
        self.assertEqual(lines[0], "tick,time_s,roam:reach_m,stalls")
        self.assertRegex(lines[1], r"^0,0,[12]\.\d+,0$")
        stopping = WORLD.replace('"quit_time_s": 2', '"quit_time_s": 2, "stop_when": ["roam:reach > 0"]')
        self.write("stop.json", stopping)
        self.assertIn("ticks              1 of", self.troupe("run", "stop.json", "--controller", "roam.py").stdout)
        checked = self.troupe("check", "stop.json", "--controller", "roam.py", "--for", "0.5")
        self.assertIn("the measure roam:reach is computed in Python: Troupe does not guarantee that its values are equal", checked.stdout)
        world = troupe.Simulation("w.json", controllers=["roam.py"])
        measures = troupe.Measures(world, ["stalls", "roam:reach", lambda robots: len(robots)])
        self.assertEqual(measures.columns, ["stalls", "roam:reach_m", "<lambda>"])
        self.assertEqual(measures.values()[1:], [np.abs(world.swarm().poses()[:, :2]).max(), 30])
        self.assertEqual(measures["<lambda>"], 30)

    def test_a_sweep_names_only_the_script_that_has_changed(self):
        self.write("study.json", '{"troupe_study": 1, "world": "w.json", "for_s": 0.2, "seeds": [1, 2]}')
        sweep = ["sweep", "study.json", "-o", "out", "--controller", "roam.py"]
        self.troupe(*sweep)
        self.write("roam.py", ROAM.replace("0.25", "0.5"))  # the state at the start differs too
        self.assertTrue(self.troupe(*sweep, code=2).stderr.endswith(
            "error: the folder contains runs with another plug-in roam: choose another folder with -o\n"))
        self.write("w.json", WORLD.replace('"count": 30', '"count": 31'))
        self.assertIn("runs with another world and another plug-in roam: ", self.troupe(*sweep, code=2).stderr)

    def test_a_function_that_declares_a_unit_has_a_column_with_the_unit(self):
        @troupe.measure(unit="m", name="edge")
        def reach(robots):
            return np.abs(robots.poses()[:, :2]).max()

        @troupe.measure
        def count(robots):
            return len(robots)

        self.write("w.json", WORLD)
        measures = troupe.Measures(troupe.Simulation("w.json"), [reach, count])
        self.assertEqual(measures.columns, ["edge_m", "count"])
        self.assertEqual([measures["edge"], measures["edge_m"], measures["count"]], [measures.values()[0]] * 2 + [30])
        with self.assertRaisesRegex(LookupError, 'unknown measure "reach"; known: count, edge_m'):
            measures["reach"]

    def test_a_measure_reads_the_memories_of_controllers(self):
        self.write("my.py", "import troupe\n\n\n@troupe.measure\ndef turn(robots):\n    return robots.readings('turn', 'roam/0')[7]\n")
        world = troupe.Simulation("w.json", controllers=["roam.py", "my.py"])
        world.step(3)
        memories = world.table("roam/0")
        order = np.argsort(memories.ids)
        self.assertEqual(troupe.Measures(world, ["my:turn"]).values()[0], memories["turn"][order][7])
        np.testing.assert_array_equal(world.swarm("r").readings("seen", "roam/0"), memories["seen"][order])
        np.testing.assert_array_equal(world.find("r0").readings("seen", "roam/0"), memories["seen"][order][0])
        self.assertEqual([field.name for field in world.find("r0").fields("roam/0")], ["turn", "steps", "seen"])
        self.write("my.py", "import troupe\n\n\n@troupe.measure\ndef turn(robots):\n    return robots.memory['turn'][7]\n")
        made = self.troupe("run", "w.json", "--controller", "my.py", "--measures", "m.csv", "--measure", "my:turn", code=1)
        self.assertRegex(made.stderr, r"my.py:6: AttributeError: .*'memory'; known: .*, readings, ")

    def test_two_functions_cannot_have_the_same_column(self):
        world = troupe.Simulation("w.json")
        for wanted in ([lambda robots: 1.0, lambda robots: 2.0], ["stalls", troupe.measure(name="stalls")(lambda robots: 1.0)]):
            with self.assertRaisesRegex(troupe.InputError, r'^two measures have the column "(<lambda>|stalls)": give one of them another'):
                troupe.Measures(world, wanted)

    def test_a_function_given_to_measures_must_not_change_the_world(self):
        world = troupe.Simulation("w.json")
        before = world.state_hash()
        kept = []

        def act(robots):
            kept.append(robots)
            acts[-1](robots)
            return 1.0

        measures = troupe.Measures(world, [act])
        for change in (lambda robots: world.step(), lambda robots: world.reset(), lambda robots: robots.set_speeds(1, 0),
                       lambda robots: robots.set_poses(robots.poses()), lambda robots: world.swarm().set_speeds(1, 0)):
            acts = [change]
            for read in (measures.values, lambda: measures["act"]):
                with self.assertRaisesRegex(RuntimeError, "^a measure must not change the world"):
                    read()
            with self.assertRaisesRegex(RuntimeError, "^the argument of a measure can be used only during the call"):
                kept[-1].poses()
        self.assertEqual((world.tick, world.state_hash()), (0, before))
        acts = [lambda robots: robots.poses()]
        self.assertEqual(measures.values(), [1.0])
        world.step()

    def test_the_argument_of_a_measure_can_be_used_only_during_the_call(self):
        self.write("my.py", "import troupe\nkept = []\n\n\n@troupe.measure\ndef keep(robots):\n    kept.append(robots)\n    return len(robots)\n")
        world = troupe.Simulation("w.json", controllers=["my.py"])
        measures = troupe.Measures(world, ["my:keep"])
        self.assertEqual(measures.values(), [30])
        kept = sys.modules["troupe_script_my"].kept[-1]
        del measures, world
        for use in (lambda: kept.poses(), lambda: len(kept), lambda: kept.ids, lambda: kept.names, lambda: kept.tick,
                    lambda: kept.time_s, lambda: kept.types, lambda: kept.set_speeds(1, 0)):
            with self.assertRaisesRegex(RuntimeError, "^the argument of a measure can be used only during the call"):
                use()
        self.assertEqual(repr(kept), "<Swarm of 30 robots>")

    def test_a_measure_with_an_unknown_unit_is_an_error_with_its_line(self):
        self.write("my.py", ROAM.replace('unit="m"', 'unit="m2"'))
        line = ROAM.splitlines().index('@troupe.measure(unit="m")') + 1
        known = "m, rad, s, m/s, rad/s, m/s^2, rad/s^2, 1/s, kg, J, W"
        with self.assertRaisesRegex(troupe.InputError, rf'my\.py:{line}: error: ValueError: unknown unit "m2"; known: {re.escape(known)}; '):
            troupe.Simulation("w.json", controllers=["my.py"])

    def test_the_unit_of_a_measure_is_a_keyword_argument(self):
        with self.assertRaises(TypeError) as raised:
            troupe.measure("m")
        self.assertEqual(str(raised.exception),
                         "measure() found 'm' in place of a function: write @troupe.measure(unit=\"m\") to give a unit")
        with self.assertRaisesRegex(TypeError, r"^the function functools.partial\(.*\) has no name: give it one with "):
            troupe.measure(functools.partial(len))

    def test_the_error_for_a_measure_of_a_missing_script_names_the_option(self):
        made = self.troupe("run", "w.json", "--measures", "m.csv", "--measure", "my:reach", code=2)
        self.assertIn('unknown measure "my"; known: ', made.stderr)
        self.assertTrue(made.stderr.endswith('; if it is a Python script, give --controller my.py (in Python: controllers=["my.py"])\n'), made.stderr)
        made = self.troupe("run", "w.json", "--set", '/types/bot/controller={"kind": "my:roam"}', code=2)
        self.assertIn('if it is a Python script, give --controller my.py (in Python: controllers=["my.py"])', made.stderr)

    def test_a_measure_that_returns_no_number_is_an_error_with_its_line(self):
        for result, found in (("'x'", "'x'"), ("None", "None"), ("robots.poses()", "an array of shape (30, 4)")):
            self.write("my.py", ROAM.replace("np.abs(robots.poses()[:, :2]).max()", result))
            made = self.troupe("run", "w.json", "--controller", "my.py", "--measures", "m.csv", "--measure", "my:reach", code=1)
            line = ROAM.splitlines().index('@troupe.measure(unit="m")') + 1
            self.assertIn(f"my.py:{line}: the measure reach returned {found}, expected a number", made.stderr)

    def test_a_film_shows_what_it_does(self):
        film = ("run", "w.json", "--for", "1", "--fps", "5", "--size", "64x64", "--film")
        for name in ("still", "roaming"):
            (self.folder / name).mkdir()
        made = subprocess.run([PROGRAM, *film, "still/%06d.png"], capture_output=True, text=True)
        if is_lacking(made.stderr):
            self.skipTest(f"no pictures here: {made.stderr}")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.troupe(*film, "roaming/%06d.png", "--controller", "roam.py")

        def pixels(file):  # without the texts before them, which state the hash of the state
            data = file.read_bytes()
            return data[data.index(b"IDAT"):]

        still, roaming = ([pixels(file) for file in sorted((self.folder / name).iterdir())] for name in ("still", "roaming"))
        self.assertEqual((len(still), len(roaming)), (6, 6))
        self.assertEqual(roaming[0], still[0], "the start is the same")
        self.assertEqual(len(set(roaming[1:]) & set(still)), 0)
        self.troupe("render", "w.json", "--at", "1", "--size", "64x64", "-o", "end.png", "--controller", "roam.py")
        self.assertEqual(pixels(self.folder / "end.png"), roaming[-1])

    def test_the_program_is_not_linked_with_python(self):
        readelf = shutil.which("readelf")
        if not readelf:
            self.skipTest("readelf is missing (apt install binutils)")
        needed = subprocess.run([readelf, "-dW", PROGRAM], check=True, capture_output=True, text=True).stdout
        self.assertIn("(NEEDED)", needed)
        self.assertNotIn("libpython", needed)
        self.assertNotIn("libpython", subprocess.run(["ldd", PROGRAM], check=True, capture_output=True, text=True).stdout)

    def test_modules_in_the_working_folder_do_not_hide_those_of_python(self):
        for name in ("json", "random", "typing"):
            self.write(f"{name}.py", "raise SystemExit('imported from the working folder')\n")
        self.write("beside.py", "")
        self.write("my.py", "import beside\n" + ROAM.replace("class roam", "class my"))
        self.troupe("run", "w.json", "--for", "0.1", "--controller", "my.py")

    def test_a_script_is_not_replaced(self):
        made = self.troupe("run", "w.json", "--for", "0.1", "--controller", "roam.py", "--hash-log", "roam.py", code=2)
        self.assertIn("roam.py: error: cannot be written: it is a script, which this command reads", made.stderr)
        self.assertEqual((self.folder / "roam.py").read_text(), ROAM)

    def test_names_of_files_need_not_be_utf_8_but_that_of_a_script(self):
        world, script = os.fsdecode(b"w\xff.json"), os.fsdecode(b"roam\xff.py")
        self.write(world, WORLD)
        self.write(script, ROAM)
        self.troupe("run", "w.json", "--controller", "roam.py", "--hash-log", "a.log")
        self.troupe("run", world, "--controller", "roam.py", "--hash-log", "b.log", "--quiet")
        self.assertEqual(self.hashes("b.log"), self.hashes("a.log"))
        found = self.troupe("run", "w.json", "--controller", script, code=2).stderr
        self.assertEqual(found, "roam\\xff.py: error: the name of a script must be UTF-8: rename the file\n")

    def test_printed_numbers_do_not_depend_on_the_locale_that_a_script_sets(self):
        variables = variables_of_locale("de_DE", self.folder)
        self.write("comma.py", "import locale\nlocale.setlocale(locale.LC_ALL, '')\n" + ROAM.replace("class roam", "class comma"))
        made = self.troupe("run", "w.json", "--controller", "comma.py", "--tile-size", "2.5", "--dry-run", **variables)
        self.assertRegex(made.stdout, r"\n  tile_m +2\.5\n")

    def test_a_summary_without_standard_output_is_not_written_into_an_output(self):
        run = ["run", "w.json", "--controller", "roam.py", "--hash-log"]
        self.troupe(*run, "a.log", "--quiet")
        done = subprocess.run(["sh", "-c", 'exec "$@" >&-', "sh", sys.executable, "-m", "troupe", *run, "b.log"],
                              stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertTrue(done.stderr.startswith("troupe: error: cannot write to standard output"), done.stderr)
        self.assertEqual((self.folder / "b.log").read_text(), (self.folder / "a.log").read_text())

    def test_an_error_of_a_script_is_told_in_a_working_folder_that_was_removed(self):
        self.write("bad.py", "import troupe\nraise ValueError('no')\n")
        gone = self.folder / "gone"
        gone.mkdir()
        command = [PROGRAM, "run", self.folder / "w.json", "--controller", self.folder / "bad.py"]
        done = subprocess.run(["sh", "-c", 'rmdir "$PWD" && exec "$@"', "sh", *command], cwd=gone, capture_output=True, text=True,
                              env={**os.environ, "TROUPE_PYTHON": sys.executable})
        self.assertEqual((done.returncode, done.stderr), (2, f"{self.folder}/bad.py:2: error: ValueError: no\n"))

    def test_a_script_that_is_a_pipe_is_refused_at_once(self):
        os.mkfifo(self.folder / "pipe.py")
        found = self.troupe("run", "w.json", "--controller", "pipe.py", code=2).stderr
        self.assertEqual(found, "pipe.py: error: this is a pipe or a device, not a regular file\n")

    def test_a_sweep_uses_both(self):
        self.write("study.json", '{"troupe_study": 1, "world": "w.json", "seeds": {"from": 1, "count": 3}, "measures": ["roam:reach"]}')
        self.troupe("sweep", "study.json", "-o", "out", "--controller", "roam.py", "--threads", "2")
        rows = (self.folder / "out" / "table.csv").read_text().splitlines()
        self.assertEqual(len(rows), 4)
        self.assertIn("roam:reach_m", rows[0])
        hash_of = rows[1].split(",")[rows[0].split(",").index("state_hash")]
        world = troupe.Simulation("w.json", seed=1, controllers=["roam.py"])
        world.step(20)
        self.assertEqual(f"{world.state_hash():016x}", hash_of)

    def test_classes_can_be_given(self):
        class Still(troupe.Controller):
            memory = {"n": "i4"}

            def decide(self, robots):
                robots.memory["n"] += np.arange(len(robots))

        world = troupe.Simulation("w.json", controllers=[Still])
        world.step(3)
        table = world.table("controllers_test:Still/0")
        self.assertEqual(sorted(table["n"].tolist()), [3 * i for i in range(30)])
        with self.assertRaisesRegex(TypeError, "neither the name of a script nor a class"):
            troupe.Simulation("w.json", controllers=[int])

    def test_commands_that_read_a_world_accept_the_script(self):
        self.write("named.json", WORLD.replace('"devices"', '"controller": {"kind": "roam"}, "devices"'))
        script = ("--controller", "roam.py")
        unknown = "named.json:6: error: /types/bot/controller/kind: unknown controller \"roam\""
        for command in ("lint", "info", "run"):
            self.assertIn(unknown, self.troupe(command, "named.json", code=2).stderr)
        self.assertEqual(self.troupe("lint", "named.json", *script).stdout, "named.json: nothing found\n")
        self.assertEqual(self.troupe("lint", "w.json", *script).stdout, "w.json: nothing found\n")
        for world in ("named.json", "w.json"):
            self.assertRegex(self.troupe("info", world, *script).stdout, "bot +30: diff, ranger eye, radio radio, led lamp, roam\n")
        self.assertIn(unknown, self.troupe("convert", "named.json", "new.json", code=2).stderr)
        self.troupe("convert", "named.json", "new.json", *script)
        for world in ("named", "new"):
            self.troupe("run", f"{world}.json", *script, "--hash-log", f"{world}.log")
        self.assertEqual(self.hashes("new.log"), self.hashes("named.log"))
        described = self.troupe("describe", "roam", *script).stdout
        self.assertTrue(described.startswith("controller roam: roam about\n"), described)
        self.assertIn("\nneeds\n  no drive\n  uses all devices of the robot; there may be at most 16\n"
                      "  one call decides for all robots of a type\n", described)
        self.assertIn("measure roam:reach (m): largest distance from the middle\n\n  takes no parameters\n",
                      self.troupe("describe", "roam:reach", *script).stdout)
        self.write("long.py", ROAM.replace('"largest distance from the middle"', '"""largest distance\n\n    from the\n    middle\n    """'))
        self.assertIn("measure long:reach (m): largest distance\n\n  from the middle\n\n  takes no parameters\n",
                      self.troupe("describe", "long:reach", "--controller", "long.py").stdout)
        self.assertIn("controllers of roam.py\n  roam  roam about\n\nmeasures of roam.py\n  roam:reach  largest distance",
                      self.troupe("describe", *script).stdout)
        self.write("my.py", ROAM.replace('robots = "r"', 'robots = "s"'))
        errors = {self.troupe(command, "w.json", "--controller", "my.py", code=2).stderr for command in ("lint", "info", "run")}
        self.assertEqual(len(errors), 1)
        self.assertIn('controller roam: unknown type, population or robot "s"; known: bot, r', errors.pop())

    def test_one_script_one_class_and_one_folder_need_no_list(self):
        class Still(troupe.Controller):
            def decide(self, robots):
                robots.set_speeds(0, 0)

        for one in ("roam.py", pathlib.Path("roam.py"), Still, ("roam.py",)):
            troupe.Simulation("w.json", controllers=one).step()
        with self.assertRaisesRegex(TypeError, "^controllers: 3 is neither the name of a script nor a class"):
            troupe.Simulation("w.json", controllers=3)
        self.write("walker.json", WORLD.replace('"devices"', '"controller": {"kind": "walker"}, "devices"'))
        for folder in (PLUGINS, str(PLUGINS), [PLUGINS]):
            troupe.Simulation("walker.json", plugin_path=folder).step()
        (self.folder / "worlds").mkdir()
        (self.folder / "walker.json").rename(self.folder / "worlds" / "walker.json")
        troupe.Simulation("walker.json", plugin_path=PLUGINS, search_path=self.folder / "worlds")

    def test_parameters(self):
        class tuned(troupe.Controller):
            params = {"speed": 0.5, "turns": 3, "is_shy": False, "mode": "slow", "gains": [0.5, 0.25]}

            def decide(self, robots):
                seen.append(dict(robots.params))
                robots.set_speeds(robots.params["speed"], 0)

        seen = []
        simulation = troupe.Simulation("w.json", controllers=tuned)
        simulation.step()
        defaults = {"speed": 0.5, "turns": 3, "is_shy": False, "mode": "slow", "gains": (0.5, 0.25)}
        self.assertEqual(seen, [defaults])
        self.assertEqual([type(value) for value in seen[0].values()], [float, int, bool, str, tuple])

        name = "controllers_test:tuned"
        given = {"/types/bot/controller": {"kind": name, "speed": 0.25, "is_shy": True, "gains": [1]}}
        simulation = troupe.Simulation("w.json", controllers=tuned, set=given)
        simulation.step()
        self.assertEqual(seen[-1], {**defaults, "speed": 0.25, "is_shy": True, "gains": (1.0,)})
        simulation.set("bot", {"controller": {"kind": name, "speed": 0.125, "mode": "fast"}})
        simulation.step(2)
        self.assertEqual(seen[-1]["mode"], "fast")
        self.assertEqual(set(simulation.swarm().speeds()[:, 0]), {0.125})
        self.assertEqual(simulation.parameters("bot")[-1],
                         {"controller": {"kind": name, "speed": 0.125, "turns": 3, "is_shy": True, "mode": "fast", "gains": [1]}})
        simulation.save("c.h5")
        resumed = troupe.Simulation.resume("c.h5", controllers=tuned)
        resumed.step(3)
        simulation.step(3)
        self.assertEqual(resumed.state_hash(), simulation.state_hash())
        self.assertEqual(seen[-1], seen[-4])
        for values, message in (({"sped": 1}, 'unknown key "sped"'), ({"turns": 1.5}, "expected a whole number"),
                                ({"mode": 1}, "expected a text"), ({"gains": "x"}, "expected a list of numbers")):
            with self.assertRaisesRegex(troupe.InputError, message):
                troupe.Simulation("w.json", controllers=tuned, set={"/types/bot/controller": {"kind": name, **values}})

    def test_parameters_of_a_script_are_keys_of_the_world(self):
        self.write("my.py", ROAM.replace("class roam", "class my").replace("    memory = {", '    params = {"cruise": 0.3}\n    memory = {')
                   .replace("np.where(near, 0.0, 0.3)", 'np.where(near, 0.0, robots.params["cruise"])'))
        self.write("my.json", WORLD.replace('"devices"', '"controller": {"kind": "my"}, "devices"'))
        script = ("--controller", "my.py", "--for", "0.5")
        self.troupe("run", "w.json", "--controller", "roam.py", "--for", "0.5", "--hash-log", "roam.log")
        self.troupe("run", "my.json", *script, "--hash-log", "same.log")
        self.troupe("run", "my.json", *script, "--set", "/types/bot/controller/cruise=0.2", "--hash-log", "slow.log")
        self.troupe("run", "w.json", *script, "--set", '/types/bot/controller={"kind": "my", "cruise": 0.2}',
                    "--hash-log", "set.log")
        self.assertNotEqual(self.hashes("slow.log"), self.hashes("same.log"))
        self.assertEqual(self.hashes("slow.log"), self.hashes("set.log"))
        self.write("wander.json", WORLD.replace('"devices"', '"controller": {"kind": "wander"}, "devices"'))
        found = self.troupe("run", "wander.json", *script, "--set", "/types/bot/controller/cruise=0.2", code=2).stderr
        self.assertIn('unknown key "cruise"', found)
        self.assertIn('--set /types/bot/controller/cruise: error: to set "cruise" of the controller of my.py, the world must '
                      'name it: "controller": {"kind": "my"}\n', found)
        found = self.troupe("run", "wander.json", *script, "--set", "/types/bot/controller/cruse=0.2", code=2).stderr
        self.assertNotIn("must name it", found)
        no_effect = ('has no effect, because the controller "my" of the script replaces the controllers of type "bot"; to set '
                     'parameters of "my", the world must name it: "controller": {"kind": "my"}\n')
        found = self.troupe("run", "wander.json", *script, "--set", "/types/bot/controller/cruise_speed_mps=0.2", code=2).stderr
        self.assertEqual("--set /types/bot/controller/cruise_speed_mps: error: " + no_effect, found)
        self.write("study.json", json.dumps({"troupe_study": 1, "world": "wander.json", "parameters": [
            {"set": "/types/bot/controller/cruise_speed_mps", "values": [0.1, 0.2]}]}))
        found = self.troupe("sweep", "study.json", "--controller", "my.py", "-o", "speeds", code=2).stderr
        self.assertEqual("study.json:1: error: /parameters/0: " + no_effect, found)
        self.assertIn("  cruise  0.3      number\n", self.troupe("describe", "my", "--controller", "my.py").stdout)

    def test_interventions_set_the_controller_of_a_script_but_none_that_it_replaces(self):
        self.write("my.py", ROAM.replace("class roam", "class my").replace("    memory = {", '    params = {"cruise": 0.3}\n    memory = {')
                   .replace("np.where(near, 0.0, 0.3)", 'np.where(near, 0.0, robots.params["cruise"])'))
        run = ("run", "at.json", "--controller", "my.py", "--for", "0.5")

        def write(controllers, controller, time_s=0.2):
            at = json.dumps([{"time_s": time_s, "set": {"type": "bot", "controller": controller}}])
            self.write("at.json", WORLD.replace('"arena"', f'"at": {at},\n"arena"').replace(
                '"devices"', f'"controllers": {json.dumps(controllers)}, "devices"'))

        write([{"kind": "expand"}], {"kind": "expand", "speed_mps": 0.1, "cone_deg": 20})
        self.assertEqual(self.troupe(*run, code=2).stderr,
                         'at.json:2: error: /at/0/set/controller: the controller "expand" of type "bot" does not run, because the '
                         'controller "my" of the script replaces it: remove this entry, or set parameters of "my", which the '
                         "world must then name\n")
        for time_s in (0.2, 9):
            write([{"kind": "expand"}, {"kind": "my"}], {"kind": "my", "cruise": 0.1}, time_s)
            self.troupe(*run, "--hash-log", f"two-{time_s}.log")
            write([{"kind": "my"}], {"kind": "my", "cruise": 0.1}, time_s)
            self.troupe(*run, "--hash-log", f"one-{time_s}.log")
            self.assertEqual(self.hashes(f"two-{time_s}.log"), self.hashes(f"one-{time_s}.log"))
        self.assertNotEqual(self.hashes("one-0.2.log"), self.hashes("one-9.log"))

    def test_the_robots_of_a_controller_may_be_a_population_without_bodies(self):
        world = troupe.Simulation("w.json", controllers=["roam.py"], robots=0)
        world.step()
        self.assertEqual((len(world.swarm()), world.tick), (0, 1))
        self.write("roam.py", ROAM.replace('robots = "r"', 'robots = "q"'))
        with self.assertRaisesRegex(troupe.InputError, 'unknown type, population or robot "q"'):
            troupe.Simulation("w.json", controllers=["roam.py"], robots=0)

    def test_misspelt_attributes_are_warnings_with_the_line_of_the_class(self):
        self.write("bot.py", ROAM.replace("class roam", "class bot").replace('robots = "r"', 'robot = "r"\n    gain = 3'))
        found = self.troupe("run", "w.json", "--controller", "bot.py", "--for", "0.2", "--quiet").stderr
        self.assertIn('bot.py:5: UserWarning: bot has the attribute "robot", which Controller does not use: did you mean "robots"?\n',
                      found)
        self.assertNotIn("gain", found)
        self.assertNotIn("UserWarning", self.troupe("run", "w.json", "--controller", "roam.py", "--for", "0.2", "--quiet").stderr)

    def test_parameters_that_cannot_be_are_errors_with_their_line(self):
        class_line = next(n for n, line in enumerate(ROAM.splitlines(), 1) if line.startswith("class "))
        kinds = "expected a bool, an int of 64 bits, a finite float, a str or a list of finite floats"
        for params, message in (
            ("[1]", f"my.py:{class_line}: error: roam.params is [1]: expected a dict of names and default values"),
            ('{"a": None}', f"my.py:{class_line}: error: roam.params['a'] is None: {kinds}"),
            ('{"a": 2**63}', kinds), ('{"a": float("inf")}', kinds), ('{"a": ["x"]}', kinds), ('{"a": [float("nan")]}', kinds),
            ('{"a b": 1}', "roam.params['a b']: the name of a parameter must be a Python identifier"),
            ('{"kind": 1}', 'has a parameter "kind", but "kind" is a key that every controller has'),
        ):
            with self.subTest(params):
                self.assertIn(message, self.error_of(('    robots = "r"', f'    robots = "r"\n    params = {params}'), 2))

    def test_values_of_parameters_are_in_the_argument_and_constant(self):
        class tuned(troupe.Controller):
            params = {"speed": 0.5}

            def decide(self, robots):
                if robots.tick == 1:
                    self.params["speed"]
                robots.params["speed"] = 1

        simulation = troupe.Simulation("w.json", controllers=tuned)
        with self.assertRaisesRegex(troupe.StepError, "AttributeError: .*read robots.params"):
            simulation.step()
        tuned.decide = lambda self, robots: robots.params.update(speed=1)
        with self.assertRaisesRegex(troupe.StepError, "AttributeError"):
            troupe.Simulation("w.json", controllers=type("other", (tuned,), {})).step()

    def test_unknown_parameters_and_fields_of_the_memory_are_named(self):
        acts = []

        class tuned(troupe.Controller):
            robots = "r"
            params = {"speed": 0.5, "turn": 1.0}
            memory = {"left": "u4", "steps": "u4"}

            def decide(self, robots):
                acts[-1](robots)

        no_field = r'ValueError: unknown field of the memory "lef"; known: left, steps \(did you mean "left"\?\)'
        for act, text in (
            (lambda robots: robots.params["sped"], r"""KeyError: 'unknown parameter "sped"; known: speed, turn \(did you mean "speed"\?\)'"""),
            (lambda robots: robots.memory["lef"], no_field),
            (lambda robots: robots.memory.__setitem__("lef", 1), no_field),
        ):
            acts.append(act)
            with self.subTest(text), self.assertRaisesRegex(troupe.StepError, text):
                troupe.Simulation("w.json", controllers=tuned).step()

    def test_values_that_do_not_fit_a_field_of_the_memory_are_errors(self):
        acts = []

        class keeper(troupe.Controller):
            robots = "r"
            memory = {"left": "u4", "small": "u1", "cut": np.zeros(3, "i4"), "real": "f4"}

            def decide(self, robots):
                acts[-1](robots.memory)

        def field(memory):
            part = memory["cut"][2:5]
            part[:, 1] = 0.5

        def assign(name, value):
            return lambda memory: memory.__setitem__(name, value)

        too_small, too_large = "cannot store -1: give whole numbers from 0 to 4294967295", "cannot store 300: give whole"
        for act, error, text in (
            (assign("left", -1), "ValueError", too_small),
            (assign("left", np.arange(30) - 1), "ValueError", too_small),
            (assign("small", np.full(30, 300)), "ValueError", too_large),
            (lambda memory: memory["small"].__setitem__(3, 300), "ValueError", too_large),
            (assign("cut", 0.5), "TypeError", "cannot store values of the type float64"),
            (lambda memory: memory["cut"].__setitem__(slice(None), 0.9), "TypeError", "cannot store values of the type float64"),
            (field, "TypeError", "'cut'. has the type int32, which cannot store values of the type float64"),
        ):
            acts.append(act)
            with self.subTest(text=text), self.assertRaisesRegex(troupe.StepError, f"{error}: memory\\[.*{text}"):
                troupe.Simulation("w.json", controllers=keeper).step()

        for act in (lambda memory: memory.left, lambda memory: setattr(memory, "left", 1)):
            acts.append(act)
            with self.assertRaisesRegex(troupe.StepError, r'the memory has no attribute "left": .* memory\["left"\]$'):
                troupe.Simulation("w.json", controllers=keeper).step()

        def fits(memory):
            memory["left"] = np.arange(30)
            memory["left"][:3] += 2**32 - 4
            memory["small"] = np.arange(30) > 3
            memory["cut"][1:3, 0] = [-5, 7]
            memory["real"] = memory["left"] / 2.0
            self.assertIs(type(memory["left"] + 1), np.ndarray)
            self.assertEqual(memory["small"].sum(), 26)
            self.assertNotIsInstance(memory["small"].sum(), np.ndarray)

        acts.append(fits)
        world = troupe.Simulation("w.json", controllers=keeper)
        world.step()
        table = next(each for each in world.tables() if each.component.endswith("keeper/0"))
        by_id = np.argsort(table.ids)
        self.assertEqual(table["left"][by_id].tolist(), [2**32 - 4, 2**32 - 3, 2**32 - 2, *range(3, 30)])
        self.assertEqual(table["cut"][by_id][:4, 0].tolist(), [0, -5, 7, 0])
        self.assertEqual(table["real"][by_id][4], 2)

    def test_a_field_of_bools_selects_robots(self):
        seen = []

        class waiter(troupe.Controller):
            robots = "r"
            memory = {"is_near": np.bool_(True), "marks": np.zeros(2, bool)}

            def decide(self, robots):
                memory = robots.memory
                seen.append((memory["is_near"].dtype, memory["marks"].dtype, robots.ids[~memory["is_near"]].tolist()))
                memory["is_near"] = robots.ids % 2 == 0
                memory["marks"][:, 1] = 1
                robots.set_speeds(0.1, 0, where=memory["is_near"])

        world = troupe.Simulation("w.json", controllers=waiter)
        world.step(2)
        odd = [robot for robot in world.swarm("r").ids.tolist() if robot % 2]
        self.assertEqual(seen, [(np.dtype(bool), np.dtype(bool), []), (np.dtype(bool), np.dtype(bool), odd)])
        table = next(each for each in world.tables() if each.component.endswith("waiter/0"))
        self.assertEqual(table["is_near"].dtype, np.uint8)
        self.assertEqual(table["is_near"].tolist(), (table.ids % 2 == 0).tolist())
        self.assertEqual(table["marks"].tolist(), [[0, 1]] * 30)

        class wrong(waiter):
            def decide(self, robots):
                robots.memory["is_near"] = 2

        with self.assertRaisesRegex(troupe.StepError, "has the type bool, which cannot store 2: give whole numbers from 0 to 1"):
            troupe.Simulation("w.json", controllers=wrong).step()

    def test_the_source_of_a_class_need_not_be_known(self):
        for names in ({}, {"__name__": "__main__"}):  # as in an interactive interpreter
            exec("import troupe\nclass own(troupe.Controller):\n  def decide(self, robots): robots.set_speeds(0.1, 0)\n"
                 "class wrong(own):\n  def decide(self): pass\n"
                 "class late(own):\n  async def decide(self, robots): pass\n", names)
            troupe.Simulation("w.json", controllers=names["own"]).step()
            for name, text in (("wrong", r"wrong.decide\(self\): expected decide\(self, robots\)"),
                               ("late", "late.decide: a call would execute none of its statements: write it without `async`")):
                with self.assertRaisesRegex(troupe.InputError, f"error: {text}"):
                    troupe.Simulation("w.json", controllers=names[name])

    def test_a_class_may_be_defined_again_many_times(self):
        for turn in np.linspace(0, 1, 70):  # as in a notebook
            class turner(troupe.Controller):
                robots = "r"
                params = {"turn": float(turn)}

                def decide(self, robots):
                    robots.set_speeds(0, robots.params["turn"])

            world = troupe.Simulation("w.json", robots=1, threads=1, controllers=turner)
            world.step(2)
            self.assertEqual(world.swarm("r").speeds()[0, 2] > 0, turn > 0)

    def test_a_class_whose_members_were_changed_is_read_again(self):
        class turner(troupe.Controller):
            robots = "r"
            params = {"turn": 0.25}

            def decide(self, robots):
                robots.set_speeds(0, robots.params["turn"])

        def world():
            made = troupe.Simulation("w.json", robots=1, threads=1, controllers=turner)
            made.step(2)
            return made

        def turn():
            return world().swarm("r").speeds()[0, 2]

        self.assertEqual(turn(), 0.25)
        turner.params = {"turn": 0.5}
        self.assertEqual(turn(), 0.5)
        turner.memory = {"count": np.uint32(7)}
        self.assertEqual(world().table("controllers_test:turner/0")["count"].tolist(), [7])
        turner.decide = lambda self, robots: robots.set_speeds(0, -0.5)
        self.assertEqual(turn(), -0.5)
        with mock.patch("troupe._script._controller", side_effect=AssertionError("read again")):
            self.assertEqual(turn(), -0.5)

    def test_a_decide_whose_statements_would_not_run_is_an_error(self):
        for change, word in (("            yield\n", "yield"), ("", "async")):
            text = ROAM.replace("class roam", "class my").replace("        memory = robots.memory\n", "        memory = robots.memory\n" + change)
            if word == "async":
                text = text.replace("def decide", "async def decide")
            line = next(n for n, each in enumerate(text.splitlines(), 1) if "def decide" in each)
            with self.subTest(word=word):
                self.write("my.py", text.replace("            yield", "        yield"))
                made = self.troupe("run", "w.json", "--controller", "my.py", code=2)
                self.assertEqual(made.stderr, f"my.py:{line}: error: my.decide: a call would execute none of its statements: write it without `{word}`\n")

    def test_the_cause_of_a_failed_step_is_the_exception_of_decide(self):
        class broken(troupe.Controller):
            robots = "r"

            def decide(self, robots):
                raise KeyError("lost")

        with self.assertRaises(troupe.StepError) as raised:
            troupe.Simulation("w.json", controllers=broken).step()
        cause = raised.exception.__cause__
        self.assertIsInstance(cause, KeyError)
        self.assertEqual(traceback.extract_tb(cause.__traceback__)[-1].name, "decide")

    def test_decide_cannot_use_the_simulation(self):
        class peeper(troupe.Controller):
            robots = "r"

            def decide(self, robots):
                world.find("r0")

        world = troupe.Simulation("w.json", controllers=peeper)
        with self.assertRaisesRegex(troupe.StepError, "or by the step that calls this code: .* decide.. of a controller may use only"):
            world.step()

    def test_a_program_can_exit_in_decide(self):
        class last(troupe.Controller):
            robots = "r"

            def decide(self, robots):
                sys.exit(3)

        with self.assertRaises(SystemExit) as raised:
            troupe.Simulation("w.json", controllers=last).step()
        self.assertEqual(raised.exception.code, 3)

    def test_control_c_waits_for_the_end_of_a_tick(self):
        self.write("slow.py", """
import troupe

class slow(troupe.Controller):
    robots = "r"
    memory = {"turns": "u4"}

    def decide(self, robots):
        print("decides", flush=True)
        for _ in range(200):
            robots.estimates()
        while robots.tick == hangs:
            pass
        robots.memory["turns"] += 1

hangs = -1
world = troupe.Simulation("w.json", threads=1, controllers=slow)
try:
    world.run_for(1e9)
except KeyboardInterrupt:
    ticks = world.tick
print("ended", all(world.table("slow/0")["turns"] == ticks), flush=True)
world.step(2)
print("goes on", world.tick - ticks, flush=True)
hangs = world.tick + 1
try:
    world.step()
except KeyboardInterrupt:
    world.reset()
    print("reset", world.tick, flush=True)
""")
        with subprocess.Popen([sys.executable, "slow.py"], stdout=subprocess.PIPE, text=True) as process:
            try:
                self.assertEqual(process.stdout.readline(), "decides\n")
                process.send_signal(signal.SIGINT)
                lines = iter(process.stdout.readline, "")
                self.assertEqual(next(line for line in lines if line != "decides\n"), "ended True\n")
                self.assertEqual(next(line for line in lines if line != "decides\n"), "goes on 2\n")
                self.assertEqual(next(lines), "decides\n")
                process.send_signal(signal.SIGINT)
                time.sleep(0.3)  # two signals at once would be one
                process.send_signal(signal.SIGINT)
                self.assertEqual(next(lines), "reset 0\n")
                process.wait(timeout=60)
            finally:
                process.kill()

    def error_of(self, change, code, *more, text=ROAM):
        self.write("my.py", text.replace(*change))
        return self.troupe("run", "w.json", "--controller", "my.py", *more, code=code).stderr

    @unittest.skipIf(sys.version_info < (3, 10), "this Python does not tell the name of the attribute")
    def test_an_unknown_attribute_is_an_error_with_a_hint(self):
        for statement, hint in (
            ("robots.set_speed(1, 0)", "Robots' object has no attribute 'set_speed'; known: accelerate, bearings, [a-z_, ]*"
             r'uniform \(did you mean "set_speeds"\?\)\n'),
            ("robots.poses()", "has no attribute 'poses'; known: accelerate, [a-z_, ]*estimates, [a-z_, ]*uniform\n"),
            ("np.zros(3)", r"module 'numpy' has no attribute 'zros' \(did you mean \"zeros\"\?\)\n"),
        ):
            found = self.error_of(('memory["steps"] += 1', statement), 1)
            with self.subTest(statement):
                self.assertRegex(found, "my.py:14: AttributeError: .*" + hint)

    def test_what_is_wrong_is_said_with_its_line(self):
        class_line = next(n for n, line in enumerate(ROAM.splitlines(), 1) if line.startswith("class "))
        for change, code, text in (
            (("import troupe\n", "import troupe\nfor\n"), 2, "my.py:3: error: SyntaxError: "),
            (("import troupe\n", "import troupe\nnope\n"), 2, "my.py:3: error: NameError: name 'nope' is not defined"),
            (("import troupe\n", "import troupe\nraise ValueError\n"), 2, "my.py:3: error: ValueError\n"),
            (("import troupe\n", "import troupe\nraise KeyboardInterrupt\n"), 2, "my.py:3: KeyboardInterrupt\n"),
            (('robots = "r"', 'robots = "s"'), 2,
             f'my.py:{class_line}: error: controller roam: unknown type, population or robot "s"; known: bot, r'),
            (('robots = "r"', "name = 3"), 2,
             f"my.py:{class_line}: error: roam.name is 3: expected a text, or None for the name of the class"),
            (('"u4"', '"u8x"'), 2, f"my.py:{class_line}: error: roam.memory['steps'] is 'u8x': expected a NumPy"),
            (('"u4"', '"c16"'), 2, "has the type complex128 and the shape (): expected a number of one of the types"),
            (('np.zeros(5, "f4")', "np.zeros((5, 2))"), 2, "has the type float64 and the shape (5, 2)"),
            (('    robots = "r"', "    uses = ['nose']"), 2, 'uses the device "nose", but no device of the type has this name or kind'),
            (('memory["steps"] += 1', "raise ValueError('no')"), 1,
             "tick 1: controller \"my:roam\" of \"r0\", the first of a batch of 30 robots, threw: my.py:14: ValueError: no"),
            (('np.where(near, 0.0, 0.3)', "np.zeros(4)"), 1, "my.py:17: ValueError: forward has shape (4,); "),
            (('memory["seen"] = robots.ranges("eye")', 'memory["seen"] = robots.ranges("eye")[:, :2]'), 1,
             "my.py:15: ValueError: "),
            (('np.where(near, 0.0, 0.3)', "np.full(len(robots), np.nan)"), 1,
             "my.py:17: ValueError: forward of row 0 is nan: give a finite number"),
            (('memory["steps"] += 1', "self.count = 1"), 1,
             'my.py:14: AttributeError: a controller cannot have the attribute "count": declare it in `memory`'),
            (("    def decide(self, robots):", "    def decied(self, robots):"), 2,
             f"my.py:{class_line}: error: roam has no function decide(self, robots): define it, to command the robots"),
            (("    def decide(self, robots):", "    def decide(robots):"), 2,
             f"my.py:{class_line + 6}: error: roam.decide(robots): expected decide(self, robots)"),
            (('memory["steps"] += 1', 'memory["steps"] = memory["steps"] + 0.5'), 1,
             "my.py:14: TypeError: memory['steps'] has the type uint32, which cannot store values of the type float64"),
            (("class roam(troupe.Controller)", "class roam"), 2,
             f'my.py:{class_line}: error: class "roam" has decide(), but is not a troupe.Controller: write '
             "class roam(troupe.Controller), or"),
            (("", ""), 2, "has the script a controller?"),
        ):
            if text.startswith("has the script"):
                self.write("my.py", "import troupe\n")
                found = self.troupe("run", "w.json", "--controller", "my.py", code=2).stderr
                text = "my.py: error: the script has no class derived from troupe.Controller"
            else:
                found = self.error_of(change, code)
            with self.subTest(text):
                self.assertIn(text, found)
        shared = "class Shared:\n    def decide(self, robots): pass\nclass own(Shared, troupe.Controller): pass\n"
        self.write("my.py", "import troupe\n" + shared)  # a base of a controller need not be one
        self.troupe("run", "w.json", "--controller", "my.py", "--for", "0.2")
        found = self.troupe("run", "w.json", "--controller", "none.py", code=2).stderr
        self.assertIn("none.py: error: there is no such file", found)
        self.write("command.py", ROAM.replace("class roam", "class command"))
        found = self.troupe("run", "w.json", "--controller", "command.py", code=2).stderr
        self.assertIn('command.py: error: it has a controller "command" that has the name of a component of the state', found)
        launched = {"OMPI_COMM_WORLD_RANK": "0", "OMPI_COMM_WORLD_SIZE": "4"}
        found = self.troupe("run", "w.json", "--controller", "roam.py", code=2, **launched).stderr
        self.assertIn("--controller works only in one process, but mpirun of Open MPI started 4", found)
        found = self.troupe("run", "w.json", "--controller", "roam.py", code=2, TROUPE_PYTHON="/no/python").stderr
        self.assertIn('"/no/python" cannot be executed', found)

    def test_a_command_between_two_ticks_replaces_that_of_the_controller_for_one_tick(self):
        world = json.loads(WORLD)
        world["types"]["bot"]["controller"] = {"kind": "script", "law": "line"}  # 0.5 m/s
        simulation = troupe.Simulation(world)
        swarm = simulation.swarm()
        simulation.step(2)
        for _ in range(3):
            self.assertEqual(set(swarm.speeds()[:, 0]), {0.5})
            for _ in range(2):
                swarm.set_speeds(0.125, 0)
                simulation.step()
                self.assertEqual(set(swarm.speeds()[:, 0]), {0.125})
            simulation.step()

    def test_the_robots_of_a_call_end_with_it(self):
        kept = []

        class Keeper(troupe.Controller):
            def decide(self, robots):
                kept.append(robots)

        world = troupe.Simulation("w.json", controllers=[Keeper])
        world.step()
        del world  # and with it the descriptions of the devices
        robots = kept[0]
        calls = {"readings": ["ranges", "eye"], "ranges": [], "bearings": [], "heard": ["f4"], "estimates": [],
                 "commands": ["lamp"], "command": ["lamp"], "say": [b"ab"], "set_speeds": [1, 0], "normal": []}
        for name, arguments in calls.items():
            with self.subTest(name), self.assertRaisesRegex(RuntimeError, "only during the call of decide"):
                getattr(robots, name)(*arguments)
        for name in "ids", "memory", "params", "tick":
            with self.subTest(name), self.assertRaisesRegex(RuntimeError, "only during the call of decide"):
                getattr(robots, name)


if __name__ == "__main__":
    unittest.main()
