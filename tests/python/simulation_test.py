"""Tests of the simulation in the Python package."""

import ast
import contextlib
import copy
import functools
import gc
import json
import math
import operator
import os
import pathlib
import pickle
import re
import subprocess
import sys
import threading
import time
import traceback
import types
import unittest.mock
import weakref

import numpy as np
import troupe
from support import (HOSPITAL, ROOM, ROOT, WAIT_S, InAFolder, has_view, needs_view, output_when_interrupted, skipped_where_lacking,
                     variables_of_locale)

sys.path.insert(0, str(ROOT))
from tests.support.websocket import Socket  # noqa: E402


class Objects(unittest.TestCase):
    """Without its constructor, an object of the module would refer to memory that is not initialised."""

    def test_no_class_makes_an_object_without_its_constructor(self):
        classes = [each for each in vars(troupe._core).values() if type(each).__name__ == "pybind11_type"]
        self.assertGreater(len(classes), 15)
        for each in classes:
            if hasattr(each, "__setstate__"):  # pickle makes such objects, which __setstate__() completes
                continue
            with self.subTest(each.__name__), self.assertRaisesRegex(
                    TypeError, rf"^{each.__name__}\.__new__\(\) makes no object: call the class, or the function that returns such"):
                each.__new__(each)

    def test_an_object_without_its_constructor_has_no_use(self):
        base = troupe.Events.__mro__[1]
        for each in (troupe.Events, troupe.Measures, troupe.Swarm, troupe.Model, troupe.Simulation, troupe.Event, troupe.Pose):
            unmade = base.__new__(each)
            for name in dir(each):
                if name.startswith("__") or not (callable(getattr(each, name)) or isinstance(vars(each).get(name), property)):
                    continue
                if isinstance(vars(each).get(name), (staticmethod, types.FunctionType)):
                    continue
                with self.subTest(f"{each.__name__}.{name}"), self.assertRaisesRegex(
                        TypeError, f"^an object of the class {each.__name__} was made without its constructor"):
                    used = getattr(unmade, name)
                    used()
        with self.assertRaisesRegex(TypeError, "without its constructor"):
            troupe.Measures(base.__new__(troupe.Simulation))
        with self.assertRaisesRegex(TypeError, "without its constructor"):
            troupe.Simulation(ROOM).swarm(of=base.__new__(troupe.Model))

    def test_derived_classes_are_made_as_before(self):
        class Watch(troupe.Events):
            def __init__(self, world):
                super().__init__(world)
                self.calls = 0

            def see(self):
                self.calls += 1
                return super().see()

        class Other(troupe.Simulation):
            def __new__(cls, *arguments, **named):
                return super().__new__(cls)

        world = Other(ROOM, threads=1)
        watch = Watch(world)
        world.step()
        self.assertEqual((watch.see(), watch.calls, world.tick), ([], 1, 1))
        self.assertEqual(pickle.loads(pickle.dumps(troupe.Pose(1, 2, 0, 3))), troupe.Pose(1, 2, 0, 3))


class Loading(InAFolder):
    def test_the_version_is_the_programs(self):
        self.assertRegex(troupe.__version__, r"^\d+\.\d+\.\d+$")
        self.assertIn(troupe.__version__, troupe.version_line())
        self.assertIn(f"project(troupe VERSION {troupe.__version__} ", (ROOT / "CMakeLists.txt").read_text())

    def test_a_file_a_text_and_a_dict_are_one_world(self):
        worlds = [
            troupe.Simulation(HOSPITAL, robots=20),
            troupe.Simulation(str(HOSPITAL), robots={"r": 20}, threads=2),
            troupe.Simulation.from_text(HOSPITAL.read_text(), HOSPITAL, robots=20),
            troupe.Simulation(str(HOSPITAL), set={"/populations/0/count": 20}, tile_size_m=3),
        ]
        for world in worlds:
            world.step(5)
        self.assertEqual(len({world.state_hash() for world in worlds}), 1)
        self.assertEqual(worlds[0].robots, 20)
        self.assertEqual(worlds[0].tick, 5)
        self.assertAlmostEqual(worlds[0].time_s, 0.5)
        self.assertEqual(worlds[0].tick_s, 0.1)
        self.assertEqual(worlds[0].quit_time_s, 60)
        self.assertEqual(worlds[1].threads, 2)

    def test_names_of_files_need_not_be_utf_8(self):
        name = os.fsdecode(b"w\xff.json")
        box = {"size_m": [1, 1, 1], "drive": {"kind": "diff"}}
        world = {"troupe": 1, "overlaps": "warn", "types": {"box": box},
                 "models": [{"name": "a", "type": "box"}, {"name": "b", "type": "box"}]}
        pathlib.Path(name).write_text(json.dumps(world))
        simulation = troupe.Simulation(name, threads=1)
        self.assertEqual(simulation.options["world"], name)
        self.assertEqual(simulation.title, name[:-len(".json")])
        self.assertEqual(repr(simulation), f'<Simulation "{simulation.title}": 2 robots, 0 s>')
        self.assertEqual([warning[:len(name)] for warning in simulation.warnings], [name])
        self.assertIn(f"\n# world: {name}\n", simulation.hash_log_header())
        with self.assertRaisesRegex(troupe.InputError, r'^w\\xff.json: error: unknown key "modells"'):
            troupe.Simulation({**world, "modells": []}, name=name)
        with self.assertRaisesRegex(RuntimeError, r"^w\\xff.json: error: cannot be written: "):
            simulation.snapshot(name)
        with self.assertRaisesRegex(RuntimeError, r"^none\\xff/a.png: error: cannot be written: "):
            simulation.snapshot(os.fsdecode(b"none\xff/a.png"))

    # In a Turkish locale, the capital of i is not I.
    def test_names_of_colours_do_not_depend_on_the_locale(self):
        variables = variables_of_locale("tr_TR", self.folder)
        world = {"troupe": 1, "types": {"box": {"size_m": [1, 1, 1], "color": "indian red"}},
                 "models": [{"name": "a", "type": "box"}]}
        done = subprocess.run([sys.executable, "-c", f"import troupe; troupe.Simulation({world})"], capture_output=True,
                              text=True, env={**os.environ, **variables})
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_values_may_be_numbers_and_arrays_of_numpy(self):
        plain = troupe.Simulation({**ROOM, "bounds_m": [[-6, -6], [6, 6]], "seed": 9}, set={"/populations/0/count": 3})
        numpy = troupe.Simulation({**ROOM, "bounds_m": np.array([[-6.0, -6], [6, 6]]), "seed": np.int64(9)},
                                  set={"/populations/0/count": np.arange(5)[3]})
        self.assertEqual(numpy.state_hash(), plain.state_hash())
        near = troupe.Measures(numpy, [{"kind": "neighbours", "radius_m": np.float32(9)}])
        self.assertEqual(near.values(), troupe.Measures(plain, [{"kind": "neighbours", "radius_m": 9}]).values())
        self.assertEqual(troupe.Simulation({**ROOM, "title": pathlib.Path("maps/room")}).title, "maps/room")
        for wrong in (1j, {1}, object(), np.array([1j])):
            with self.assertRaisesRegex(TypeError, "^a value of the type [a-z]+ has no counterpart in JSON: give a dict, "):
                troupe.Simulation({**ROOM, "seed": wrong})

    def test_the_error_for_a_number_that_is_not_finite_names_its_place(self):
        world = troupe.Simulation(ROOM)
        for make, place in (
            (lambda nan: troupe.Simulation({**ROOM, "tick_s": nan}), "/tick_s"),
            (lambda nan: troupe.Simulation({**ROOM, "bounds_m": np.array([[-6, -6], [6, nan]])}), "/bounds_m/1/1"),
            (lambda nan: troupe.Simulation({**ROOM, "types": {**ROOM["types"], "a/b~c": {"size_m": (nan, 1)}}}), "/types/a~1b~0c/size_m/0"),
            (lambda nan: troupe.Simulation(ROOM, set={"/types/bot/drive/velocity_max_x_mps": nan}), "/types/bot/drive/velocity_max_x_mps"),
            (lambda nan: troupe.Simulation(ROOM, set=[("/bounds_m", [[0, 0], [nan, 1]])]), "/bounds_m/1/0"),
            (lambda nan: world.set("bot", {"drive": {"velocity_max_x_mps": nan}}), "/drive/velocity_max_x_mps"),
        ):
            for value in (math.nan, np.float32("nan"), -math.inf):
                with self.subTest(place=place, value=value), self.assertRaises(ValueError) as raised:
                    make(value)
                self.assertEqual(str(raised.exception), f"{place} is {value}: give a finite number")
        endless = []
        endless.append(endless)
        with self.assertRaisesRegex(ValueError, "Circular reference"):
            troupe.Simulation({**ROOM, "bounds_m": endless})

    def test_the_text_of_a_world_is_no_file_name(self):
        for text in (json.dumps(ROOM), "include\n"):
            with self.assertRaisesRegex(ValueError, "^world: found the text of a world where the name of a file is expected: "):
                troupe.Simulation(text)

    def test_options_take_effect(self):
        world = troupe.Simulation(ROOM, seed=2**64 - 1, ranging="grid", threads=1, set={"/title": "Mine"})
        self.assertEqual(world.title, "Mine")
        self.assertEqual(world.options["seed"], str(2**64 - 1))
        self.assertEqual(world.options["ranging"], "grid")
        self.assertEqual(world.options["set /title"], '"Mine"')
        self.assertEqual(repr(world), '<Simulation "Mine": 7 robots, 0 s>')

    def test_input_errors_list_what_is_wrong(self):
        world = copy.deepcopy(ROOM)
        world["types"]["bot"]["drive"]["kind"] = "hover"
        world["types"]["cart"]["size_m"] = [1, 1, 0]
        with self.assertRaises(troupe.InputError) as caught:
            troupe.Simulation(world, name="made.json")
        self.assertIsInstance(caught.exception, ValueError)
        self.assertEqual(type(caught.exception).__module__, "troupe")
        findings = caught.exception.findings
        self.assertEqual(len(findings), 2, findings)
        self.assertRegex(findings[0], r'^made\.json: error: /types/bot/drive/kind: unknown drive "hover"; known: ')
        self.assertIn("/types/cart/size_m", findings[1])
        self.assertEqual(str(caught.exception), "\n".join(findings))
        self.assertEqual(pickle.loads(pickle.dumps(caught.exception)).findings, findings)
        with self.assertRaises(troupe.InputError) as caught:
            troupe.Simulation({"troupe": 1, "models": [{"name": "a", "type": "x\x0cy\u2028z"}]})
        self.assertEqual(len(caught.exception.findings), 1, "only line ends end a finding")
        with self.assertRaises(troupe.InputError) as caught:
            troupe.Simulation(ROOM, controllers="none.py")
        self.assertEqual(caught.exception.findings, ["none.py: error: there is no such file"])
        first = ROOM["populations"][0]
        with self.assertRaisesRegex(troupe.InputError, '^dict.json: error: /populations/1: unknown key "sed"'):
            troupe.Simulation({**ROOM, "populations": [first, {**first, "name": "s", "sed": 1}]})
        with self.assertRaisesRegex(troupe.InputError, "^text.json:1: error: "):
            troupe.Simulation.from_text('{"troupe": 1, "sed": 1}')
        with self.assertRaisesRegex(troupe.InputError, "^none.world: error: there is no such file$"):
            troupe.Simulation("none.world")
        with self.assertRaisesRegex(ValueError, 'unknown ranging "gird"; known: exact, grid'):
            troupe.Simulation(ROOM, ranging="gird")
        most = 2**64 - 1
        count = "give a whole number from 0 to 10000000, or a dict from names of populations to such numbers"
        for options, error, text in (
            ({"seed": -1}, ValueError, f"seed: found -1: give a whole number from 0 to {most}"),
            ({"seed": 2**64}, ValueError, f"seed: found {2**64}: give a whole number from 0 to {most}"),
            ({"seed": 1.5}, TypeError, f"seed: found 1.5: give a whole number from 0 to {most}"),
            ({"seed": "1"}, TypeError, f"seed: found '1': give a whole number from 0 to {most}"),
            ({"robots": -5}, ValueError, f"robots: found -5: {count}"),
            ({"robots": 2.5}, TypeError, f"robots: found 2.5: {count}"),
            ({"robots": ["r"]}, TypeError, f"robots: found ['r']: {count}"),
        ):
            for load in (lambda **options: troupe.Simulation(ROOM, **options),
                         lambda **options: troupe.Simulation.from_text(json.dumps(ROOM), **options)):
                with self.subTest(options), self.assertRaises(error) as raised:
                    load(**options)
                self.assertEqual(str(raised.exception), text)
        world = troupe.Simulation(ROOM, seed=np.uint64(3))
        for seed, error in ((-1, ValueError), (2**64, ValueError), (1.5, TypeError)):
            with self.assertRaises(error) as raised:
                world.reset(seed=seed)
            self.assertEqual(str(raised.exception), f"seed: found {seed}: give a whole number from 0 to {most}")
        world.reset(seed=np.int64(4))
        self.assertEqual(world.seed, 4)
        for size in (-1, math.nan, math.inf):
            with self.assertRaisesRegex(ValueError, f"tile_size_m is {size:g}: give a number from 0"):
                troupe.Simulation(ROOM, tile_size_m=size)
        size = "give a whole number from 0 to 10000000"
        for robots, error, text in (({"r": -1}, ValueError, f"robots['r']: found -1: {size}"),
                                    ({"r": 2**64}, ValueError, f"robots['r']: found {2**64}: {size}"),
                                    ({"r": 1.5}, TypeError, f"robots['r']: found 1.5: {size}"),
                                    ({3: 1}, TypeError, "robots: found the key 3: give the name of a population")):
            with self.assertRaisesRegex(error, f"^{re.escape(text)}$"):
                troupe.Simulation(ROOM, robots=robots)
        with self.assertRaisesRegex(TypeError, "set: the key 1 is not a JSON pointer: give a text"):
            troupe.Simulation(ROOM, set={1: 2})
        with self.assertRaisesRegex(ValueError, r'set: the value "\\ud800" contains half of a surrogate pair'):
            troupe.Simulation(ROOM, set={"/title": "\ud800"})
        with self.assertRaisesRegex(TypeError, "set: the key 1 is not a JSON pointer: give a text"):
            troupe.Simulation(ROOM, set=[("/seed", 1), (1, 2)])
        with self.assertRaisesRegex(TypeError, "set: the list has the element '/seed': give tuples of a JSON pointer"):
            troupe.Simulation(ROOM, set=["/seed"])

    def test_arguments_that_do_not_fit_are_one_clear_message(self):
        world = troupe.Simulation(ROOM)
        batch = troupe.BatchEnv(world, {"teams": [{"name": "bots", "robots": "bot"}]})
        known = "file, width, height, camera, layers, center_m, angle_rad, across_m, color_by, color_range, background"
        for call, text in (
            (lambda: troupe.Simulation(7), "world: found 7: give a dict or a path"),
            (lambda: troupe.Simulation(), 'Simulation() needs the argument "world": give a dict or a path'),
            (lambda: troupe.Simulation(ROOM, tile_size_m="a"), "tile_size_m: found 'a': give a number"),
            (lambda: troupe.Simulation(ROOM, world=ROOM),
             'Simulation() has two values for the argument "world": one by position and one by name'),
            (lambda: world.snapshot("a.png", camra="top"),
             f'snapshot() has no keyword argument "camra"; known: {known} (did you mean "camera"?)'),
            (lambda: world.picture(1.5), "width: found 1.5: give a whole number"),
            (lambda: world.find(3), "name: found 3: give a text"),
            (lambda: world.record("a.h5", replace=np.bool_(True), fields=3), "fields: found 3: give a list of texts"),
            (lambda: world.record("a.h5", replace="no"), "replace: found 'no': give True or False"),
            (lambda: world.run_for(), 'run_for() needs the argument "seconds": give a number'),
            (lambda: world.swarm().set_speeds(1), 'set_speeds() needs the argument "turn"'),
            (lambda: world.state_hash(3), "state_hash() takes at most 0 arguments without a name, found 1"),
            (lambda: world.find("\ud800"), r"name: found '\ud800': give a text"),
            (lambda: world.save("a\0.h5"), r"checkpoint: found 'a\x00.h5': give a path"),
            (lambda: troupe.Simulation("\ud800"), r"world: found '\ud800': give a dict or a path"),
            (lambda: world.find("r0").set_speed(np.ones(2), 0), "forward: found array([1., 1.]): give a number"),
            (lambda: world.model(np.arange(2)), "id: found array([0, 1]): give a whole number"),
            (lambda: world.swarm().set_speeds(None, 0), "forward: found None: give one number, or one per robot"),
            (lambda: world.on_tick(), 'on_tick() needs the argument "callback"'),
            (lambda: troupe.Measures(world, 3),
             "wanted: found 3: give a list whose elements are each a text or a dict or a function"),
            (lambda: world.spawn("r", (1, 2)), "pose: found (1, 2): give a troupe.Pose or a tuple (x, y, heading)"),
            (lambda: world.find("r0").set_pose([1, 2, 3]),
             "pose: found [1, 2, 3]: give a troupe.Pose or a tuple (x, y, heading)"),
            (lambda: troupe.Simulation.from_text(3), "text: found 3: give a text"),
            (lambda: world.cast((0, 0, 0), "far"), "range_max: found 'far': give a number"),
            (lambda: world.swarm().set_poses(None), "poses: found None: give x, y, z (m) and heading (rad) per robot"),
            (lambda: world.swarm().set_poses(np.full((9, 4), 1j)),
             "poses: found [[1j, 1j, 1j, 1j], [1j, 1j, 1j, 1j], [1j, 1j, 1j, 1j], [1j, 1j, 1j, 1j], [1j, 1j, 1j, 1j], "
             "[1j, 1j, 1j, 1j], ...]: give numbers"),
            (lambda: world.cast_many([["0"] * 4], 1), "starts: found [['0', '0', '0', '0']]: give numbers"),
            (lambda: world.cast_many("east", 1), "starts: found 'east': give numbers"),
            (lambda: world.cast_many([[1], [1, 2]], 1),
             "starts: found [[1], [1, 2]]: give an array of n x 4: x, y, z (m) and heading (rad) of each ray"),
            (lambda: world.set_poses([(world.find("cart"), "here")]),
             "poses: found [(<Model cart>, 'here')]: give a list of tuples (a troupe.Model, a troupe.Pose or a tuple (x, y, heading))"),
            (lambda: setattr(troupe.Pose(), "heading", "north"), "found 'north': give a number"),
            (lambda: troupe.Pose(("a", 1, 2)), "x_y_heading: found ('a', 1, 2): give three numbers"),
            (lambda: troupe.Measures(world, [functools.partial(len)]),
             "wanted: the function functools.partial(<built-in function len>) has no name: give it one with "
             "troupe.measure(function, name=...)"),
            (lambda: world.model(-1), "id: found -1: the number is out of range"),
            (lambda: world.view(port=70000), "port: found 70000: the number is out of range"),
            (lambda: batch.picture(-1, 64), "copy: found -1: the number is out of range"),
            (lambda: batch.picture(-1, -64), "copy: found -1, width: found -64: one of these numbers is out of range"),
            (lambda: batch.reset([True]), "which: found [True]: give a NumPy array or None"),
            (lambda: batch.step(True), "begins: found True: give a NumPy array or None"),
            (lambda: troupe.Pose("a"),
             "Pose() takes (x: a number, y: a number, heading: a number, z: a number) or (x_y_heading: a tuple); found ('a')"),
        ):
            with self.subTest(text), self.assertRaises(TypeError) as raised:
                call()
            self.assertEqual(str(raised.exception), text)
        with self.assertRaisesRegex(TypeError, r"^Simulation\(\) takes at most 1 argument without a name, found 2: give robots, "):
            troupe.Simulation(ROOM, 500)

    def test_types_as_newer_versions_of_pybind11_write_them_are_read(self):
        signature = ("poses: list[tuple[troupe._core.Model, troupe._core.Pose]] = [], names: list[str] = [], "
                     "center_m: Optional[Annotated[list[float], FixedSize(2)]] = None, done: Optional[Callable] = None")
        text = ("act(): incompatible function arguments. The following argument types are supported:\n"
                f"    1. (self: object, {signature}) -> None\n\nInvoked with: 1")
        for arguments, error in (
            ({"poses": 3}, "poses: found 3: give a list of tuples (a troupe.Model, a troupe.Pose or a tuple (x, y, heading))"),
            ({"names": "r0"}, "names: found 'r0': give a list of texts"),
            ({"center_m": (1, 2, 3), "done": None}, "center_m: found (1, 2, 3): give a list of 2 numbers or None"),
            ({"center_m": None, "done": 3}, "done: found 3: give a function or None"),
        ):
            self.assertEqual(troupe._arguments.message(text, (None,), arguments), error)

    def test_a_type_error_of_the_program_keeps_its_text(self):
        def callback(_):
            raise TypeError("mine(): incompatible with yours")

        with self.assertRaisesRegex(TypeError, r"^mine\(\): incompatible with yours$"):
            try:
                troupe.Simulation(ROOM).run_for(1, callback)
            except TypeError as error:
                self.assertIn("callback", [each.name for each in traceback.extract_tb(error.__traceback__)])
                raise

    def test_docstrings_are_at_most_120_columns_wide(self):
        members = [(name, member) for name, member in vars(troupe._core).items() if not name.startswith("__")]
        for name, kind in members[:]:
            if isinstance(kind, type):
                members += [(f"{name}.{each}", member) for each, member in vars(kind).items() if not each.startswith("__")]
        texts = {name: (member.__doc__ or "").splitlines() for name, member in members}
        self.assertGreater(len(texts), 200)
        self.assertEqual([(name, line) for name, lines in texts.items() for line in lines if len(line) > 120 and "->" not in line],
                         [])
        sources = list(pathlib.Path(troupe.__file__).parent.rglob("*.py"))
        self.assertGreater(len(sources), 10)
        for file in sources:
            lines = file.read_text(encoding="utf-8").splitlines()
            for node in ast.walk(ast.parse("\n".join(lines))):
                if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node) is not None:
                    text = node.body[0]
                    self.assertEqual([line for line in lines[text.lineno - 1:text.end_lineno] if len(line) > 120], [], file)
        for name in troupe.math.__all__:
            self.assertRegex(getattr(troupe.math, name).__doc__, r"(?m)^Returns ")

    def test_warnings_are_told(self):
        world = troupe.Simulation.from_text('position( name "a" colour "red" )', "a.world")
        self.assertEqual(len(world.warnings), 1)
        self.assertRegex(world.warnings[0], r"^a\.world:1: warning: .*colour")


class Running(InAFolder):
    def test_run_for_calls_back_after_each_tick(self):
        world = troupe.Simulation(ROOM)
        seen = []
        world.run_for(1.0, lambda simulation: seen.append(simulation.tick))
        self.assertEqual(seen, [1, 2, 3, 4, 5])
        world.run_for(0.5)
        self.assertEqual(world.tick, 8)  # rounded up to whole ticks
        with self.assertRaisesRegex(ValueError, "give a time from 0"):
            world.run_for(-1)
        with self.assertRaises(ZeroDivisionError):
            world.run_for(1, lambda simulation: 1 / 0)
        self.assertEqual(world.tick, 9)

    def test_reset_and_resume_give_the_same_bits(self):
        world = troupe.Simulation(ROOM)
        swarm = world.swarm("bot")
        swarm.set_speeds(0.3, np.linspace(-1, 1, len(swarm)))
        world.step(10)
        middle, hashes = world.state_hash(), world.hashes()
        self.assertEqual(hashes["state"], middle)
        self.assertEqual(set(hashes), {"state", "pose", "velocity", "sensor", "memory"})
        world.reset()
        self.assertEqual(world.tick, 0)
        swarm.set_speeds(0.3, np.linspace(-1, 1, len(swarm)))
        world.step(10)
        self.assertEqual(world.state_hash(), middle)
        with skipped_where_lacking():
            world.save("middle.h5")
        world.step(10)
        later = troupe.Simulation.resume("middle.h5", threads=2)
        self.assertEqual(later.state_hash(), middle)
        later.step(10)
        self.assertEqual(later.state_hash(), world.state_hash())
        (self.folder / "bad.h5").write_bytes(b"\x89HDF")
        with self.assertRaisesRegex(troupe.InputError, "^bad.h5: error: "):
            troupe.Simulation.resume("bad.h5")

    def test_a_checkpoint_in_memory_gives_the_same_bits(self):
        world = troupe.Simulation(ROOM, threads=1)
        world.swarm("bot").set_speeds(0.3, 0.5)
        world.step(10)
        with skipped_where_lacking():
            data = world.to_bytes()
        middle = world.state_hash()
        world.step(10)
        for copied in (data, bytearray(data), memoryview(data)):
            later = troupe.Simulation.from_bytes(copied, threads=2)
            self.assertEqual((later.tick, later.threads, later.state_hash()), (10, 2, middle))
            later.step(10)
            self.assertEqual(later.state_hash(), world.state_hash())
        self.assertEqual(os.listdir(), [])
        for wrong, text in ((b"", "data: error: this is not a checkpoint: the file is empty"),
                            (data[:1000], "data: error: "), (b"abc", "data: error: this is not a checkpoint")):
            with self.assertRaises(troupe.InputError) as raised:
                troupe.Simulation.from_bytes(wrong)
            self.assertEqual(str(raised.exception)[:len(text)], text)
        with self.assertRaises(TypeError) as raised:
            troupe.Simulation.from_bytes("c.h5")
        self.assertEqual(str(raised.exception), "data: found 'c.h5': give the bytes that to_bytes() has returned")
        with self.assertRaises(TypeError) as raised:
            troupe.Simulation.from_bytes(data, thread=2)
        self.assertRegex(str(raised.exception), r'^from_bytes\(\) has no keyword argument "thread"; known: data, threads, set, '
                                                r'.* \(did you mean "threads"\?\)$')

    def test_ranks_give_the_same_bits(self):
        def drive(world):
            swarm = world.swarm("r")
            seen = swarm.ranges()
            swarm.set_speeds(0.3, seen[:, 0] - seen[:, 2])
            cart = world.find("cart")
            if world.tick == 3:
                cart.set_pose((1, 4, 0))
            if world.tick == 4:
                world.spawn("r", (-3, -3, 0))
            if world.tick == 6:
                world.remove(world.find("r2"))

        worlds = [troupe.Simulation(ROOM, threads=1, ranks=ranks) for ranks in (1, 2, 3)]
        self.assertEqual([world.ranks for world in worlds], [1, 2, 3])
        hashes = set()
        for world in worlds:
            world.swarm("r").subscribe()
            views = [world.find(name).ranges() for name in ("r0", "r3", "r5")]  # which show new values after each step
            world.on_tick(drive)
            world.step(10)
            seen = tuple(tuple(view) for view in views)
            hashes.add((world.state_hash(), seen, tuple(world.table("command")["x"])))
        self.assertEqual(len(hashes), 1)
        with skipped_where_lacking():
            worlds[2].save("c.h5")
        resumed = troupe.Simulation.resume("c.h5", threads=1, ranks=2)
        self.assertEqual(resumed.ranks, 2)
        for world in (worlds[0], resumed):
            world.on_tick(None)
            world.step(5)
        self.assertEqual(resumed.state_hash(), worlds[0].state_hash())

    def test_ranks_are_1_to_1024(self):
        for ranks in (0, 1025):
            with self.assertRaisesRegex(ValueError, f"^{ranks} ranks: must be 1 to 1024$"):
                troupe.Simulation(ROOM, ranks=ranks)
            with self.assertRaisesRegex(ValueError, f"^{ranks} ranks: must be 1 to 1024$"):
                troupe.Simulation.from_text(HOSPITAL.read_text(), HOSPITAL, ranks=ranks)
        with self.assertRaisesRegex(ValueError, "^ranks: found -1: give a whole number from 1 to 1024$"):
            troupe.Simulation(ROOM, ranks=-1)

    def test_ranks_are_refused_if_a_launcher_started_several_processes(self):
        launcher = {"OMPI_COMM_WORLD_RANK": "0", "OMPI_COMM_WORLD_SIZE": "3"}
        with unittest.mock.patch.dict(os.environ, launcher):
            self.assertEqual(troupe.Simulation(ROOM).ranks, 1)
            with self.assertRaisesRegex(ValueError, "^2 ranks: .* but mpirun of Open MPI started 3 processes: start the "):
                troupe.Simulation(ROOM, ranks=2)

    def test_other_threads_run_meanwhile_and_may_not_use_it(self):
        world = troupe.Simulation(HOSPITAL, robots=500, threads=1)
        swarm = world.swarm()
        refused, turns = [], 0
        stepper = threading.Thread(target=world.step, args=(300,))
        stepper.start()
        while stepper.is_alive():
            turns += 1
            for use in (world.state_hash, swarm.ranges, lambda: world.tick):
                try:
                    use()
                except RuntimeError as error:
                    refused.append(str(error))
            time.sleep(0.001)
        stepper.join()
        self.assertGreater(turns, 5)
        self.assertGreater(len(refused), turns)
        self.assertIn("is being used by another thread", refused[0])
        self.assertEqual(world.tick, 300)

    def test_a_tick_waits_for_a_thread_that_began_to_use_the_world_in_a_callback(self):
        world = troupe.Simulation(ROOM, threads=1)
        ended = []

        def cast():
            world.cast_many(np.full((1000000, 4), 0.1), 4)
            ended.append(True)

        user = threading.Thread(target=cast)

        def begin(simulation):
            user.start()
            with self.assertRaisesRegex(RuntimeError, "is being used by another thread"):
                while user.is_alive():
                    time.sleep(0.001)
                    world.tick

        interval = sys.getswitchinterval()
        sys.setswitchinterval(60)  # so that the thread is not interrupted between its cast and its end
        try:
            world.run_for(0.2, begin)
            self.assertEqual(ended, [True])
        finally:
            sys.setswitchinterval(interval)
            user.join()
        world.step()

    def test_control_c_ends_it_between_two_ticks(self):
        code = f"""
import threading
import troupe
world = troupe.Simulation({str(HOSPITAL)!r}, robots=50)
def tell():
    try:
        while True:
            world.tick
    except RuntimeError:  # the main thread steps the world
        print("begun", flush=True)
threading.Thread(target=tell).start()
try:
    world.run_for(1e9)
except KeyboardInterrupt:
    hash = world.state_hash()
    ticks = world.tick
    world.reset()
    world.step(ticks)
    print("same" if world.state_hash() == hash else "other")
"""
        self.assertEqual(output_when_interrupted(code, 0.3), "same\n")  # after some ticks

    @needs_view
    def test_control_c_ends_the_wait_of_a_batch_for_its_view(self):
        code = f"""
import tempfile
import troupe
team = {{"name": "r", "robots": "r", "arrays": [], "actions": [{{"command": "forward", "low": 0, "high": 1}}],
        "rewards": [], "ends": []}}
def batch():
    world = troupe.Simulation({ROOM!r}, threads=1)
    made = troupe.BatchEnv(world, {{"copies": 4, "threads": 3, "ticks": 2, "seconds": 100.0, "teams": [team]}})
    made.reset()
    return made
watched, alone = batch(), batch()
with tempfile.TemporaryDirectory() as folder:
    view = watched.view(2, rate=0.001, out=folder)  # a tick of 0.2 s would take 200 s
    for _ in range(2):
        try:
            print("begun", flush=True)
            watched.step()
            watched.step()
        except KeyboardInterrupt:
            pass
    view.close()
watched.step()
while alone.tick() < watched.tick():
    alone.step()
print("same" if [alone.state_hash(i) for i in range(4)] == [watched.state_hash(i) for i in range(4)] else "other")
"""
        self.assertEqual(output_when_interrupted(code, 1, 1), "same\n")

    @needs_view
    def test_too_few_threads_for_a_watched_batch_are_an_error_that_says_so(self):
        """A step of a batch with a view runs on a further thread, whose stack does not fit into the address space."""
        code = f"""
import resource, tempfile
import troupe
team = {{"name": "r", "robots": "r", "arrays": [], "actions": [{{"command": "forward", "low": 0, "high": 1}}],
        "rewards": [], "ends": []}}
batch = troupe.BatchEnv(troupe.Simulation({ROOM!r}, threads=1),
                        {{"copies": 2, "threads": 1, "ticks": 2, "seconds": 100.0, "teams": [team]}})
batch.reset()
with tempfile.TemporaryDirectory() as folder:
    view = batch.view(rate=0, out=folder)
    usual = resource.getrlimit(resource.RLIMIT_AS)
    used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + (4 << 20), usual[1]))
    try:
        batch.step()
    except RuntimeError as error:
        print(error)
    resource.setrlimit(resource.RLIMIT_AS, usual)
    batch.step()
    view.close()
print(batch.tick())
"""
        done = subprocess.run(["sh", "-c", 'ulimit -s 65536 && exec "$@"', "sh", sys.executable, "-c", code],
                              capture_output=True, text=True, timeout=WAIT_S)
        self.assertEqual(done.stderr, "")
        self.assertRegex(done.stdout, "^the system allows no further thread \\(use fewer threads, or raise the limits "
                                      "on threads and memory of this process\\): .*\n3\n$")

    def test_a_thread_that_steps_as_the_interpreter_exits_ends_quietly(self):
        code = f"""
import threading, time
import troupe
world = troupe.Simulation({str(HOSPITAL)!r}, robots=50, threads=2)
def step():
    while True:
        world.step(3)
def load():
    while True:
        troupe.Simulation({str(HOSPITAL)!r}, robots=5)
watched = troupe.Simulation({str(HOSPITAL)!r}, robots=5, threads=1)
watched.on_tick(lambda simulation: sum(range(1000)))
def call():
    while True:
        watched.run_until(lambda simulation: sum(range(1000)) < 0, 1)
for run in (step, load, call):
    threading.Thread(target=run, daemon=True).start()
time.sleep(0.3)
print("over")
"""
        for _ in range(5):
            done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=WAIT_S)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "over\n", ""))

    def test_threads_are_those_that_the_process_may_use(self):
        code = f"""
import os
os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])
import troupe
print(troupe.Simulation({str(HOSPITAL)!r}, robots=5).threads)
eight = troupe.Simulation({str(HOSPITAL)!r}, robots=5, threads=8)
eight.step()
print(eight.threads)
"""
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=WAIT_S)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "1\n8\n", ""))
        for threads in (1025, 100_000, 2**32 - 1):
            with self.assertRaisesRegex(ValueError, f"^{threads} threads: must be 1 to 1024, or 0 for one per "):
                troupe.Simulation(ROOM, threads=threads)
        for threads in (-1, 2**32, 2**64):
            with self.assertRaisesRegex(ValueError, f"^threads: found {threads}: give a whole number from 0 to 1024$"):
                troupe.Simulation(ROOM, threads=threads)
        with self.assertRaisesRegex(TypeError, "^threads: found 1.5: give a whole number from 0 to 1024$"):
            troupe.Simulation(ROOM, threads=1.5)
        world = troupe.Simulation(ROOM, threads=1)
        for ticks in (-1, 2**64):
            with self.assertRaisesRegex(ValueError, f"^ticks: found {ticks}: give a whole number from 0 to {2**64 - 1}$"):
                world.step(ticks)
        world.step(np.int64(2))
        self.assertEqual(world.tick, 2)

    def test_a_step_that_failed_ends_the_use_until_a_reset(self):
        fails = [True]

        class Fails(troupe.Controller):
            robots = "bot"

            def decide(self, robots):
                if fails[0]:
                    raise ValueError("no")

        world = troupe.Simulation(ROOM, controllers=Fails)
        robot, swarm, poses = world.find("r3"), world.swarm("r"), world.table("pose")
        measures, events = troupe.Measures(world, ["stalls"]), troupe.Events(world)
        with self.assertRaisesRegex(troupe.StepError, '"r0"') as caught:
            world.step()
        self.assertIsInstance(caught.exception, RuntimeError)
        for use in (
            world.step,
            lambda: world.run_for(1),
            lambda: world.save("c.h5"),
            lambda: world.record("r.h5"),
            world.state_hash,
            world.statistics,
            world.tables,
            lambda: poses["x"],
            robot.pose,
            lambda: robot.set_speed(1, 0),
            robot.ranges,
            swarm.poses,
            swarm.ranges,
            lambda: swarm.set_speeds(1, 0),
            measures.see,
            measures.values,
            events.see,
        ):
            with self.assertRaisesRegex(RuntimeError, "^tick 1: a step, a birth or a reset failed .* call reset"):
                use()
        self.assertEqual(list(self.folder.iterdir()), [])
        fails[0] = False
        world.reset()
        world.step()
        self.assertEqual(world.tick, 1)

    def test_a_command_that_is_not_a_finite_number_is_an_error_at_once(self):
        world = troupe.Simulation(ROOM)
        swarm = world.swarm("r3")
        for x in (math.inf, -math.inf, math.nan):
            for act in (lambda: swarm.set_speeds(x, 0), lambda: swarm.set_speeds(0, x), lambda: swarm.accelerate(x, 0),
                        lambda: swarm.go_to(0, x, 0), lambda: world.find("r3").set_speed(x, 0)):
                with self.assertRaisesRegex(ValueError, f'^"r3" was commanded .*{x}.*: give finite numbers$'):
                    act()
        for texts in ("0.15", ["0.15"]):
            with self.assertRaisesRegex(TypeError, f"^forward: found {re.escape(repr(texts))}: give numbers$"):
                swarm.set_speeds(texts, 0)
        world.step()
        stack = 'position( name "base" size [1 1 0.4] position( name "top" size [0.3 0.3 0.2] drive "omni" ) )'
        world = troupe.Simulation.from_text(stack, "stack.world")
        with self.assertRaisesRegex(ValueError, '"base.top" was commanded inf, 0, 0: give finite numbers'):
            world.find("base.top").set_speed(math.inf, 0)


class Callbacks(InAFolder):
    def test_are_called_in_order_behind_every_step(self):
        world = troupe.Simulation(ROOM)
        calls = []

        @world.on_tick
        def first(simulation):
            self.assertIs(simulation, world)
            calls.append(("first", simulation.tick))

        world.on_tick(lambda simulation: calls.append(("second", simulation.tick)))
        world.step()
        world.run_for(0.2, lambda simulation: calls.append(("own", simulation.tick)))
        self.assertTrue(world.run_until(lambda simulation: True, 1))
        self.assertEqual(
            calls,
            [("first", 1), ("second", 1), ("first", 2), ("second", 2), ("own", 2), ("first", 3), ("second", 3)],
        )
        world.reset()
        world.step()
        self.assertEqual(calls[-2:], [("first", 1), ("second", 1)])
        self.assertIsNone(world.on_tick(None))
        world.step(3)
        self.assertEqual(calls[-1], ("second", 1))
        with self.assertRaises(TypeError):
            world.on_tick(3)

    def test_drive_as_a_loop_does(self):
        called, looped = troupe.Simulation(ROOM), troupe.Simulation(ROOM)

        def drive(world):
            cart = world.find("cart")
            cart.set_speed(0.2, cart.random("drive").uniform(-1, 1))
            if world.tick == 3:
                cart.set_pose((1, 4, 0))

        called.on_tick(drive)
        called.step(8)
        for _ in range(8):
            looped.step()
            drive(looped)
        self.assertEqual(called.state_hash(), looped.state_hash())

    def test_may_not_step_and_their_exceptions_come_out(self):
        world = troupe.Simulation(ROOM)
        for name, act in {
            "step": lambda s: s.step(),
            "run_for": lambda s: s.run_for(1),
            "run_until": lambda s: s.run_until(lambda _: True, 1),
            "reset": lambda s: s.reset(),
            "on_tick": lambda s: s.on_tick(None),
        }.items():
            world.on_tick(act)
            text = rf"^{name}\(\) is not allowed in a callback of on_tick\(\), run_for\(\) or run_until\(\): call it outside the callback$"
            with self.assertRaisesRegex(RuntimeError, text):
                world.step()
            world.on_tick(None)
            other = troupe.Simulation(ROOM)
            for run in (lambda: other.run_for(1, act), lambda: other.run_until(act, 1)):
                with self.assertRaisesRegex(RuntimeError, text):
                    run()
            self.assertEqual(other.tick, 2)
        world.on_tick(lambda simulation: 1 / 0)
        with self.assertRaises(ZeroDivisionError):
            world.step()
        self.assertEqual(world.tick, 6)

    def test_that_would_execute_no_statement_are_errors(self):
        def generator(simulation):
            yield simulation.tick

        async def asynchronous(simulation):
            return True

        for callback, word in ((generator, "yield"), (asynchronous, "async"), (lambda simulation: generator(simulation), "yield")):
            world = troupe.Simulation(ROOM)
            text = f"that a call executes none of its statements: write it without `{word}`$"
            for run in (lambda: world.run_until(callback, 1), lambda: world.run_for(1, callback), lambda: world.on_tick(callback) and world.step()):
                with self.subTest(word=word), self.assertRaisesRegex(TypeError, text):
                    run()
            with self.assertRaisesRegex(TypeError, text):
                troupe.Measures(troupe.Simulation(ROOM), [callback]).values()

    def test_that_know_their_simulation_go_with_it(self):
        class Watcher:
            def __init__(self, world):
                self.world = world
                self.swarm = world.swarm()

            def __call__(self, simulation):
                self.swarm.poses()

        watcher = Watcher(troupe.Simulation(ROOM))
        watcher.world.on_tick(watcher)
        watcher.world.step()
        gone = weakref.ref(watcher)
        del watcher
        gc.collect()
        self.assertIsNone(gone())

    def test_runs_end_with_the_predicate_the_time_or_the_world(self):
        world = troupe.Simulation(ROOM)
        self.assertTrue(world.run_until(lambda simulation: simulation.tick == 4, 60))
        self.assertEqual(world.tick, 4)
        self.assertFalse(world.run_until(lambda simulation: False, 0.4))
        self.assertEqual(world.tick, 6)
        for true in (np.True_, 1, "yes", [0], np.ones(1)):
            self.assertTrue(world.run_until(lambda simulation: true, 60))
        for false in (np.False_, 0, None, "", np.zeros(1)):
            self.assertFalse(world.run_until(lambda simulation: false, 0.4))
        with self.assertRaisesRegex(ValueError, "truth value of an array"):
            world.run_until(lambda simulation: np.ones(2), 60)
        with self.assertRaisesRegex(ValueError, r"run_until\(-1\): give a time from 0"):
            world.run_until(lambda simulation: True, -1)
        ending = troupe.Simulation({**ROOM, "stop_when": ["displacement > 0.3"]})
        ending.swarm("r").set_speeds(0.5, 0)
        self.assertIsNone(ending.stopped)
        ending.run_for(60)
        ticks = ending.tick
        self.assertLess(ticks, 100)
        self.assertEqual(ending.stopped, "displacement > 0.3")
        self.assertFalse(ending.run_until(lambda simulation: True, 1))
        ending.step()
        self.assertEqual(ending.tick, ticks + 1)


class Rays(InAFolder):
    def test_meet_the_nearest_and_say_whose_it_is(self):
        world = troupe.Simulation(ROOM)
        cart = world.find("cart")
        wall = world.cast(troupe.Pose(1, 4.5, 0, z=0.1), 10)
        self.assertAlmostEqual(wall.range_m, 3.9)
        self.assertEqual(world.model(wall.body).name, "east")
        self.assertEqual(world.cast(cart.pose(), 10).body, cart.id)
        self.assertNotEqual(world.cast(cart.pose(), 10, without=cart).body, cart.id)
        nothing = world.cast((1, 4.5, np.pi), 10)
        self.assertEqual((nothing.range_m, nothing.body, nothing.met()), (10, None, False))
        with self.assertRaisesRegex(ValueError, "range_max"):
            world.cast((0, 0, 0), -1)
        with self.assertRaisesRegex(LookupError, "no model with id 99"):
            world.model(99)

    def test_many_are_as_one_each(self):
        world = troupe.Simulation(ROOM)
        starts = np.zeros((30, 4))
        starts[:, 2], starts[:, 3] = 0.1, np.linspace(-3, 3, 30)
        ranges, bodies = world.cast_many(starts, 6)
        self.assertEqual((ranges.dtype, bodies.dtype), (np.float64, np.int64))
        for start, far, body in zip(starts, ranges, bodies):
            one = world.cast(troupe.Pose(z=0.1, heading=start[3]), 6)
            self.assertEqual((far, body), (one.range_m, -1 if one.body is None else one.body))
        self.assertGreater((bodies >= 0).sum(), 5)
        starts[7, 1] = np.nan
        with self.assertRaisesRegex(ValueError, "^row 7 of starts is 0, nan, 0.1, .*: give finite numbers$"):
            world.cast_many(starts, 6)
        with self.assertRaisesRegex(ValueError, "starts has shape .30, 3."):
            world.cast_many(starts[:, :3], 6)


class Devices(InAFolder):
    WORLD = {
        **ROOM,
        "types": {
            **ROOM["types"],
            "bot": {
                **ROOM["types"]["bot"],
                "sensors": [
                    *ROOM["types"]["bot"]["sensors"],
                    {"name": "cam", "kind": "camera", "width": 8, "height": 4},
                ],
                "devices": [{"name": "lamp", "kind": "led", "shows": [0, 0, 1]}],
            },
        },
    }

    def test_every_sensor_is_read(self):
        world = troupe.Simulation(self.WORLD)
        robot = world.find("r0")
        depth = robot.readings("depth")
        self.assertEqual((depth.dtype, depth.shape), (np.float32, (32,)))
        world.step()
        self.assertGreater(depth.max(), 0)  # a view, not a copy
        with self.assertRaises(ValueError):
            depth[0] = 1
        self.assertEqual(robot.readings("color", "cam").shape, (4 * 32,))
        np.testing.assert_array_equal(robot.readings("ranges", "eye"), robot.ranges())
        self.assertEqual([field.name for field in robot.fields("cam")], ["color", "depth"])
        with self.assertRaisesRegex(LookupError, r'devices of "r0": unknown field "dept".*did you mean "depth"'):
            robot.readings("dept")
        with self.assertRaisesRegex(LookupError, 'no device "cat"; it has: eye, cam, lamp'):
            robot.fields("cat")

    def test_devices_are_asked(self):
        world = troupe.Simulation(self.WORLD)
        robot = world.find("r0")
        self.assertEqual(
            robot.command("lamp", shows=1, red=1, green=0.5), {"shows": 1, "red": 1.0, "green": 0.5, "blue": 0.0}
        )
        world.step(2)
        self.assertEqual(robot.readings("shown_color").tolist(), [1, 0.5, 0])
        self.assertEqual(robot.command("lamp", blue=np.float32(1))["red"], 1.0)
        with self.assertRaisesRegex(LookupError, 'device "lamp" of "r0": unknown command field "read"; known: .*did you mean "red"'):
            robot.command("lamp", read=1)
        for wrong in (256, -1, 0.5, [1, 2], "on"):
            with self.assertRaises((ValueError, TypeError)):
                robot.command("lamp", red=0.25, shows=wrong)
        self.assertEqual(robot.command("lamp")["red"], 1.0)  # the invalid command changed nothing
        with self.assertRaisesRegex(LookupError, 'no device that takes commands "eye"; it has: lamp'):
            robot.command("eye")

    def test_random_numbers_are_of_robot_name_and_tick(self):
        draws = []
        for _ in range(2):
            world = troupe.Simulation(ROOM)
            random = world.find("r0").random("a")
            draws.append((random.uniform(), random.uniform(2, 3), random.normal(), random.exponential(), random.below(9)))
            others = (world.find("r1").random("a"), world.find("r0").random("b"))
            self.assertTrue(all(other.uniform() != draws[-1][0] for other in others))
            with self.assertRaises(ValueError):
                random.below(0)
        self.assertEqual(*draws)
        self.assertTrue(2 <= draws[0][1] < 3 and 0 <= draws[0][4] < 9)


class Models(InAFolder):
    def test_one_robot(self):
        world = troupe.Simulation(ROOM)
        cart = world.find("cart")
        self.assertEqual(cart.name, "cart")
        self.assertEqual(cart.size(), (0.4, 0.4, 0.2))
        cart.set_speed(0.5, 0.1, left=-0.2)
        world.step()
        self.assertEqual(tuple(cart.speed()), (0.5, -0.2, 0.1))
        x, y, heading = cart.pose()
        self.assertAlmostEqual(x, 0.1)
        self.assertAlmostEqual(y, 3.96)
        self.assertAlmostEqual(heading, 0.02)
        cart.set_pose((1, 4, 0))
        self.assertEqual(cart.pose(), troupe.Pose(1, 4))
        self.assertEqual(cart.pose(), cart.estimate())
        self.assertTrue(cart.is_free(troupe.Pose(x=2, y=4)))
        self.assertFalse(cart.is_free((5, 4, 0)))
        with self.assertRaisesRegex(ValueError, "give .x, y, heading"):
            troupe.Pose((1, 2))
        self.assertEqual(cart.sensors(), ["eye"])
        self.assertEqual(cart, world.model(cart.id))
        self.assertEqual({cart: 1}[world.find("cart")], 1)
        self.assertNotEqual(cart, world.find("r0"))
        self.assertNotEqual(cart, troupe.Simulation(ROOM).find("cart"))
        self.assertNotEqual(cart, "cart")
        self.assertIsNone(cart.energy())
        self.assertEqual(cart.flag_count(), 0)
        with self.assertRaisesRegex(LookupError, 'no model "card" in .*did you mean "cart"'):
            world.find("card")
        with self.assertRaisesRegex(RuntimeError, "has no drive"):
            world.find("east").set_speed(1, 0)

    def test_births_and_deaths(self):
        world = troupe.Simulation(ROOM)
        events = troupe.Events(world)
        self.assertEqual(world.unborn("r"), 2)
        born = world.spawn("r", (0, -4.5, 0))
        self.assertEqual(born.name, "r6")
        self.assertIsNone(world.spawn("r", (0, -4.5, 0)))  # another body is in the way
        world.remove(world.find("r0"))
        self.assertFalse(world.find("r0").is_alive())
        world.step()
        told = {(event.type, event.robot) for event in events.see()}
        self.assertEqual(told, {("birth", "r6"), ("death", "r0")})
        self.assertEqual(world.robots, 7)
        self.assertNotIn("r0", world.robot_names)
        with self.assertRaisesRegex(LookupError, 'no population "q"'):
            world.spawn("q", (0, 0, 0))
        with self.assertRaisesRegex(RuntimeError, "another simulation"):
            world.remove(troupe.Simulation(ROOM).find("r1"))

    def test_parameters_change_while_it_runs(self):
        world = troupe.Simulation(ROOM)
        before = world.parameters("cart")
        drive = next(each["drive"] for each in before if "drive" in each)
        world.set("cart", {"drive": {"velocity_max_x_mps": drive["velocity_max_x_mps"] + 1}})
        after = next(each["drive"] for each in world.parameters("cart") if "drive" in each)
        self.assertEqual(after, {**drive, "velocity_max_x_mps": drive["velocity_max_x_mps"] + 1})
        with self.assertRaisesRegex(ValueError, "velocity_min_x, velocity_max_x: lower bound"):
            world.set("cart", {"drive": {"velocity_max_x_mps": -100}})
        with self.assertRaisesRegex(ValueError, 'unknown type "x"'):
            world.set("x", {"drive": {"velocity_max_x_mps": 1}})
        with self.assertRaisesRegex(LookupError, 'unknown type "x"'):
            world.parameters("x")
        world.reset()
        self.assertEqual(world.parameters("cart"), before)

    @needs_view
    def test_a_view_names_the_command_that_repeats_its_session(self):
        file = self.folder / "room.json"
        file.write_text(json.dumps({**ROOM, "mortal": True}))
        with contextlib.closing(troupe.Simulation(file, seed=7).view(out=self.folder)) as view:
            self.assertEqual(view.command, f"troupe run {file} --seed 7 --session {view.session}")
        with contextlib.closing(troupe.Simulation.from_text(json.dumps(ROOM), "none.json").view(out=self.folder)) as view:
            self.assertEqual(view.command, "", "no command can load this world")

    @needs_view
    def test_a_view_steps_it_or_the_program_does(self):
        world = troupe.Simulation.from_text(json.dumps({**ROOM, "mortal": True}), "room.json")
        view = world.view(rate=500, out=self.folder)  # two seconds, in which the user acts
        self.assertRegex(view.address, r"^http://127\.0\.0\.1:\d+/#[0-9a-f]{32}$")
        self.assertNotEqual(view.address, view.read_only_address)
        port, token = view.address.removeprefix("http://127.0.0.1:").split("/#")
        answers = []

        def act():
            with Socket(int(port)) as viewer:
                viewer.send(token)
                viewer.receive()
                answers.append(viewer.ask(do="disable", robot="cart"))
                answers.append(viewer.ask(do="restart"))
                while True:  # until the run is over
                    viewer.state()
        user = threading.Thread(target=act, daemon=True)
        user.start()
        view.run(for_s=1000)
        self.assertEqual(world.tick, 5000)
        self.assertEqual([answer["type"] for answer in answers], ["done", "done"])
        world.step(5)
        self.assertEqual(world.tick, 5005, "the program goes on")
        lines = [json.loads(line) for line in (self.folder / "room.session.jsonl").read_text().splitlines()]
        self.assertEqual([line.get("do") for line in lines], [None, "disable", "end"])
        self.assertEqual(view.session, self.folder / "room.session-2.jsonl")
        view.close()
        with self.assertRaisesRegex(RuntimeError, "closed"):
            view.run()
        world.step()

    @needs_view
    def test_close_ends_a_run_in_another_thread(self):
        world = troupe.Simulation(ROOM)

        def is_stepping():
            try:
                return world.state_hash() is None
            except RuntimeError:
                return True

        for is_watched in (False, True):  # without a user, run() waits for one
            view = world.view(rate=0, out=self.folder)
            port, token = view.address.removeprefix("http://127.0.0.1:").split("/#")
            runner = threading.Thread(target=view.run)
            runner.start()
            until = time.monotonic() + WAIT_S
            while not is_stepping() and time.monotonic() < until:
                time.sleep(0.01)
            if is_watched:
                with Socket(int(port)) as viewer:
                    viewer.send(token)
                    viewer.receive()
                    while viewer.state()["tick"] < 10:
                        pass
                    view.close()
            else:
                view.close()
            runner.join(WAIT_S)
            self.assertFalse(runner.is_alive())
            with self.assertRaisesRegex(RuntimeError, "closed"):
                view.run()
            before = world.tick
            world.step()
            self.assertEqual(world.tick, before + 1)
        self.assertGreater(world.tick, 10)

    @needs_view
    def test_a_view_runs_for_whole_ticks(self):
        world = troupe.Simulation.from_text(json.dumps({**ROOM, "tick_s": 0.1}), "room.json")
        view = world.view(rate=0, out=self.folder)
        port, token = view.address.removeprefix("http://127.0.0.1:").split("/#")
        with Socket(int(port)) as viewer:
            viewer.send(token)
            viewer.receive()
            for for_s, tick in ((0.6, 6), (0.3, 9), (0, 9), (0.1, 10)):
                view.run(for_s=for_s)
                self.assertEqual(world.tick, tick)

    @needs_view
    def test_the_options_of_a_view_are_checked(self):
        world = troupe.Simulation(ROOM)
        for rate in (-1, float("nan"), 1e-300, 1e7):
            with self.assertRaisesRegex(ValueError, "give 0 .as fast as possible., or a multiple of real time from 0.001"):
                world.view(rate=rate, out=self.folder)
        for host in ("", ":80", "a b", "a/b"):
            with self.assertRaisesRegex(ValueError, "host name"):
                world.view(hosts=[host], out=self.folder)
        self.assertEqual(list(self.folder.iterdir()), [])

    @needs_view
    def test_a_view_calls_the_callbacks_of_on_tick(self):
        world = troupe.Simulation(ROOM)
        view = world.view(rate=0, out=self.folder)
        port, token = view.address.removeprefix("http://127.0.0.1:").split("/#")
        calls = []

        def close(simulation):
            with self.assertRaisesRegex(RuntimeError, r"^View.run\(\) is not allowed in a callback"):
                view.run()
            simulation.find("cart").set_speed(0.1, 0)
            if simulation.tick == 7:
                view.close()

        with Socket(int(port)) as viewer:
            viewer.send(token)
            viewer.receive()
            world.on_tick(lambda simulation: calls.append((simulation is world, simulation.tick)))
            view.run(for_s=1)
            self.assertEqual(calls, [(True, tick) for tick in range(1, 6)])
            world.on_tick(lambda simulation: 1 / 0)
            with self.assertRaises(ZeroDivisionError):
                view.run(for_s=1)
            self.assertEqual(world.tick, 6)
            world.on_tick(None)
            world.on_tick(close)
            view.run(for_s=100)
        self.assertEqual(world.tick, 7, "a callback has closed the view")
        with self.assertRaisesRegex(RuntimeError, "closed"):
            view.run()

    @needs_view
    def test_a_simulation_has_one_view(self):
        world = troupe.Simulation(ROOM)
        view = world.view(rate=0, out=self.folder)
        with self.assertRaisesRegex(RuntimeError, r"^the simulation already has a view, .*View.close\(\)"):
            world.view(out=self.folder)
        view.close()
        with contextlib.closing(world.view(rate=0, out=self.folder)):
            world.step()

    @needs_view
    def test_an_error_in_a_plotted_measure_ends_the_plot_and_not_the_run(self):
        (self.folder / "my.py").write_text(
            "import troupe\n\nfails = []\n\n\n@troupe.measure\ndef bad(robots):\n"
            "    if fails:\n        raise ValueError('it fails')\n    return 1.0\n"
        )
        world = troupe.Simulation(ROOM, controllers=["my.py"])
        view = world.view(rate=0, out=self.folder)
        port, token = view.read_only_address.removeprefix("http://127.0.0.1:").split("/#")
        with Socket(int(port)) as viewer:
            viewer.send(token)
            viewer.receive()
            plotted, told = [], []

            def use():
                plotted.append(viewer.ask(do="plot", measure="my:bad", id=7)["type"])
                while not told:
                    message = viewer.receive()
                    if isinstance(message, bytes):
                        viewer.send('{"do": "drawn"}')
                    elif message["type"] == "refused":
                        told.append(message)

            user = threading.Thread(target=use, daemon=True)
            user.start()
            while user.is_alive():
                world.step()
                time.sleep(0.01)
                if plotted:
                    sys.modules["troupe_script_my"].fails.append(True)
        self.assertEqual(plotted, ["done"])
        self.assertEqual(told[0]["id"], 7)
        self.assertIn("it fails", told[0]["reason"])

    @needs_view
    def test_the_time_of_a_view_is_checked(self):
        view = troupe.Simulation(ROOM).view(rate=0, out=self.folder)
        for seconds in (math.nan, -1, math.inf, 1e13):
            with self.assertRaisesRegex(ValueError, r"^View.run\(for_s=.*\): give a time from 0 to .* s, or None$"):
                view.run(for_s=seconds)

    @needs_view
    def test_a_view_released_during_a_step_ends_after_the_step(self):
        world = troupe.Simulation(ROOM)
        view = world.view(rate=0.001, out=self.folder)  # the second tick would wait for 200 s
        stepping = threading.Thread(target=lambda: world.step(3), daemon=True)
        stepping.start()
        with self.assertRaisesRegex(RuntimeError, "is being used by another thread"):
            while stepping.is_alive():
                world.state_hash()
        del view
        stepping.join(WAIT_S)
        self.assertFalse(stepping.is_alive())
        self.assertEqual(world.tick, 3)
        lines = [json.loads(line) for line in (self.folder / "dict.session.jsonl").read_text().splitlines()]
        self.assertEqual((lines[-1]["do"], lines[-1]["tick"]), ("end", 3))

    @unittest.skipIf(has_view(), "this build has a view")
    def test_a_build_without_view_says_so(self):
        with self.assertRaisesRegex(RuntimeError, "^the live view is not available: Troupe was built without it; "
                                                  "build it with the CMake option -DTROUPE_VIEW=ON$"):
            troupe.Simulation(ROOM).view(out=self.folder)
        self.assertEqual(list(self.folder.iterdir()), [], "no session is begun")

    @needs_view
    def test_a_view_of_several_ranks_is_that_of_one(self):
        """The same session on one rank and on three ranks: users see and change robots of all ranks."""
        shown = []
        for ranks in (1, 3):
            (self.folder / str(ranks)).mkdir()
            world = troupe.Simulation.from_text(json.dumps({**ROOM, "mortal": True}), "room.json", ranks=ranks)
            self.assertEqual(world.ranks, ranks)
            view = world.view(rate=0.01, out=self.folder / str(ranks))  # slow until the user has paused it
            port, token = view.address.removeprefix("http://127.0.0.1:").split("/#")
            lines = []

            def use(port=port, token=token, lines=lines):
                with Socket(int(port)) as viewer:
                    viewer.send(token)
                    viewer.receive()
                    viewer.ask(do="pause")
                    viewer.ask(do="rate", rate=0)
                    while viewer.state()["playing"]:
                        pass
                    self.assertEqual(viewer.ask(do="restart")["type"], "done")
                    for robot in [f"r{i}" for i in range(6)] + ["cart"]:
                        self.assertEqual(viewer.ask(do="hold", robot=robot, speed=[0.2, 0, 0.5])["type"], "done")
                    self.assertEqual(viewer.ask(do="disable", robot="r2")["type"], "done")
                    viewer.ask(do="inspect", robot="r5")
                    viewer.ask(do="step", ticks=30)
                    state = viewer.state()
                    while state["playing"] or not state["line"]:
                        state = viewer.state()
                    lines += [state["line"], state["inspected"]["pose"]]
                    viewer.ask(do="until", time_s=20)
            user = threading.Thread(target=use)
            user.start()
            view.run(for_s=19)
            user.join()
            self.assertEqual(lines[0].split()[0], "30")
            shown.append((lines, world.state_hash()))
        self.assertEqual(shown[0], shown[1])

    def test_ranges_are_shown_not_copied(self):
        world = troupe.Simulation(ROOM)
        cart = world.find("cart")
        ranges = cart.ranges()
        self.assertEqual(ranges.dtype, np.float32)
        self.assertEqual(ranges.tolist(), [0] * 5)
        world.step()
        self.assertGreater(ranges.min(), 0)
        with self.assertRaises(ValueError):
            ranges[0] = 1
        with self.assertRaises(ValueError):
            ranges.setflags(write=True)
        self.assertEqual(cart.intensities().size, 0)


class Tables(InAFolder):
    def test_show_the_state_without_a_copy(self):
        world = troupe.Simulation(ROOM)
        pose = world.table("pose")
        self.assertEqual(len(pose), 9)
        self.assertEqual([field.name for field in pose.fields], ["x", "y", "z", "heading"])
        self.assertEqual(pose.fields[3].unit, "rad")
        x = pose["x"]
        self.assertEqual((x.dtype, x.strides), (np.float64, (32,)))
        self.assertIs(x.base, world)
        swarm = world.swarm()
        swarm.set_speeds(0.5, 0.5)
        before = x.copy()
        world.step(3)
        self.assertTrue((x != before).any())
        order = np.argsort(pose.ids)
        present = np.isin(pose.ids[order], swarm.ids)
        np.testing.assert_array_equal(x[order][present][:7], swarm.poses()[:7, 0])
        with self.assertRaises(ValueError):
            x[0] = 1
        with self.assertRaises(ValueError):
            x.setflags(write=True)
        with self.assertRaisesRegex(LookupError, 'unknown field of pose "q"; known: '):
            pose["q"]

    def test_is_a_mapping_from_the_names_of_its_fields(self):
        pose = troupe.Simulation(ROOM).table("pose")
        names = ["x", "y", "z", "heading"]
        self.assertEqual((pose.keys(), [*pose]), (names, names))
        self.assertTrue("x" in pose and "q" not in pose and 0 not in pose)
        fields = dict(pose)
        self.assertEqual([*fields], names)
        np.testing.assert_array_equal(fields["y"], pose["y"])

    def test_of_one_name_are_told_apart_by_their_types(self):
        world = troupe.Simulation(ROOM)
        world.step()
        with self.assertRaisesRegex(ValueError, "robots of 2 types have the component .*; give the parameter `type`: one of .*bot"):
            world.table("ranger/eye")
        eyes = world.table("ranger/eye", "bot")
        self.assertEqual(eyes.type, "bot")
        ranges = eyes["ranges"]
        self.assertEqual((ranges.dtype, ranges.shape), (np.float32, (8, 3)))
        bots = world.swarm("bot")
        np.testing.assert_array_equal(ranges[np.argsort(eyes.ids)], bots.ranges())
        with self.assertRaisesRegex(LookupError, 'unknown component "ranger/ear"; known: command, eye, life, '):
            world.table("ranger/ear")
        with self.assertRaisesRegex(LookupError, 'unknown type "bott"; known: .*bot.*did you mean "bot"'):
            world.table("pose", type="bott")
        with self.assertRaisesRegex(LookupError, 'unknown component of type bot "eyes"; known: .*eye.*did you mean "eye"'):
            world.table("eyes", "bot")
        self.assertIn("stall", [table.component for table in world.tables()])

    def test_of_a_device_have_the_name_that_the_world_gives_it(self):
        world = troupe.Simulation(ROOM)
        world.step()
        eyes = world.table("eye", "bot")
        self.assertEqual((eyes.component, eyes.name), ("ranger/eye", "eye"))
        np.testing.assert_array_equal(eyes["ranges"], world.table("ranger/eye", "bot")["ranges"])
        self.assertTrue(repr(eyes).startswith("<Table eye: 8 rows"))
        with self.assertRaisesRegex(LookupError, 'unknown component "eyes"; known: .*eye.*did you mean "eye"'):
            world.table("eyes")
        lantern = {"size_m": [0.1, 0.1, 0.1], "drive": {"kind": "diff"}, "devices": [{"name": "eye", "kind": "led"}]}
        two = {**ROOM, "types": {**ROOM["types"], "lantern": lantern},
               "models": [*ROOM.get("models", []), {"name": "lantern", "type": "lantern", "pose": {"z_m": 5}}]}
        with self.assertRaisesRegex(ValueError, "the name eye stands for 2 components; use the name that belongs to only one of them: .*ranger/eye"):
            troupe.Simulation(two).table("eye")

    def test_are_found_without_a_look_at_all_robots(self):
        many = {"troupe": 1, "types": {"bot": ROOM["types"]["bot"]},
                "populations": [{"name": "r", "type": "bot", "count": 100000,
                                 "place": {"rule": "grid", "pitch_m": 1, "region_m": [[-160, -160], [160, 160]]}}]}
        world = troupe.Simulation(many, threads=1)
        for _ in range(10000):  # minutes if each call looked at the types of all robots
            heading = world.table("pose")["heading"]
        self.assertEqual((len(heading), world.table("pose").type), (100000, "bot"))

    def test_have_no_readings_of_sensors_that_do_not_run(self):
        bot = {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "sensors": [
            {"name": "sonar", "kind": "ranger", "active": False, "transducers": [{"range_max_m": 5}]}]}
        resting = {"troupe": 1, "arena": {"size_m": [4, 4]}, "types": {"bot": bot},
                   "models": [{"name": "a", "type": "bot"}, {"name": "b", "type": "bot", "pose": {"y_m": 1}}]}
        world = troupe.Simulation(resting)
        world.subscribe("b")
        world.step()
        sonar = world.table("sonar")
        self.assertFalse(sonar.runs)
        self.assertIn("does not run", repr(sonar))
        ranges = dict(zip(sonar.ids, sonar["ranges"].reshape(-1)))
        self.assertTrue(np.isnan(ranges[world.find("a").id]))
        self.assertEqual(ranges[world.find("b").id], 2)
        self.assertFalse(sonar["ranges"].flags.writeable)
        self.assertTrue(world.table("pose").runs)

    def test_keep_their_world_alive(self):
        world = troupe.Simulation(ROOM)
        world.step()
        views = [world.table("pose")["x"], world.table("pose").ids, world.find("cart").ranges()]
        swarm, copies = world.swarm(), [np.array(view) for view in views]
        del world
        gc.collect()
        for _ in range(20):
            troupe.Simulation(ROOM).step()  # would reuse the memory of `world`, if it had been freed
        for shown, kept in zip(views, copies):
            np.testing.assert_array_equal(shown, kept)
        self.assertEqual(swarm.poses().shape, (9, 4))


class Swarms(InAFolder):
    def setUp(self):
        super().setUp()
        self.world = troupe.Simulation(ROOM)
        self.bots = self.world.swarm("bot")

    def test_are_in_the_order_of_ids(self):
        everybody = self.world.swarm()
        self.assertEqual(everybody.names, ["cart", "r0", "r1", "r2", "r3", "r4", "r5", "r6", "r7"])
        self.assertTrue((np.diff(everybody.ids.astype(int)) > 0).all())
        self.assertEqual(everybody.types, ["bot", "cart"])
        self.assertEqual(len(self.bots), 8)
        self.assertEqual(self.bots.alive().tolist(), [True] * 6 + [False] * 2)
        self.assertTrue(np.isnan(self.bots.poses()[6:, 0]).all())

    def test_say_what_models_say(self):
        self.bots.set_speeds(np.arange(8) / 10, -0.5)
        self.world.step(10)
        ranges, poses, speeds, stalled = (
            self.bots.ranges("eye"), self.bots.poses(), self.bots.speeds(), self.bots.stalled()
        )
        self.assertEqual((ranges.dtype, ranges.shape, stalled.dtype), (np.float32, (8, 3), np.bool_))
        for i, name in enumerate(self.bots.names[:6]):
            robot = self.world.find(name)
            np.testing.assert_array_equal(ranges[i], robot.ranges())
            self.assertEqual(tuple(poses[i, [0, 1, 3]]), tuple(robot.pose()))
            self.assertEqual(tuple(speeds[i]), tuple(robot.speed()))
            self.assertEqual(stalled[i], robot.stalled())
        np.testing.assert_array_equal(self.bots.estimates()[:6], poses[:6])
        np.testing.assert_allclose(self.bots.bearings(), np.radians([-45, 0, 45]))
        self.assertGreaterEqual(self.bots.range_bound(), 3)
        ranges[:] = -1  # a copy, which the caller may change
        self.assertGreater(self.bots.ranges()[:6].min(), 0)

    def test_commands_are_for_all_or_for_some(self):
        where = np.arange(8) < 3
        self.bots.set_speeds(0.25, 0.5, where=where)
        self.world.step()
        self.assertEqual(self.bots.speeds()[:6, 0].tolist(), [0.25] * 3 + [0] * 3)
        self.bots.accelerate(np.full(8, 1.0), 0, where=~where)
        self.world.step()
        self.assertEqual(self.bots.speeds()[2].tolist(), [0.25, 0, 0.5])
        self.assertGreater(self.bots.speeds()[3, 0], 0.1)
        self.bots.set_speeds(0.125, 0, where=[True] + [False] * 7)
        self.world.step()
        self.assertEqual(self.bots.speeds()[0].tolist(), [0.125, 0, 0])
        poses = self.bots.poses()
        poses[:6] = np.column_stack([np.arange(6) - 3, np.full(6, -4.5), np.zeros(6), np.zeros(6)])
        self.bots.set_poses(poses, where=np.arange(8) < 6)
        np.testing.assert_array_equal(self.bots.poses()[:6], poses[:6])
        self.bots.go_to(0, np.linspace(-3, 3, 8), 0)
        self.world.step()
        self.assertNotEqual(self.bots.speeds()[0].tolist(), [0, 0, 0])

    def test_shapes_that_do_not_fit_are_told(self):
        for wrong in (np.zeros(7), np.zeros((8, 1)), np.zeros((8, 8))):
            with self.assertRaisesRegex(ValueError, "turn has shape .*; for a swarm of 8 robots give one number, or one per robot"):
                self.bots.set_speeds(0, wrong)
        with self.assertRaisesRegex(ValueError, "where, an array of int64, has shape .8,.; .* give one bool per robot"):
            self.bots.set_speeds(0, 0, where=np.arange(8))
        for wrong in ([0, 1], True, "all", [True] * 7):
            with self.assertRaisesRegex(ValueError, "^where, an array of .* give one bool per robot"):
                self.bots.set_speeds(0, 0, where=wrong)
        with self.assertRaisesRegex(ValueError, "poses has shape .8, 3."):
            self.bots.set_poses(np.zeros((8, 3)))
        for wrong in ("fast", None):
            with self.assertRaises((TypeError, ValueError)):
                self.bots.set_speeds(wrong, 0)
        with self.assertRaisesRegex(ValueError, "different rangers"):
            self.world.swarm().ranges("eye")
        with self.assertRaisesRegex(LookupError, 'unknown type or population of robots "bit".*did you mean "bot"'):
            self.world.swarm("bit")
        with self.assertRaisesRegex(LookupError, '^"wall" has no drive: robots are bodies with a drive$'):
            self.world.swarm("wall")
        with self.assertRaisesRegex(ValueError, "outside the world's bounds"):
            self.bots.set_poses(np.full((8, 4), 1e9))

    def test_a_population_may_have_no_robots(self):
        empty = {**ROOM["populations"][0], "count": 0, "reserve": 0}
        none = troupe.Simulation({**ROOM, "populations": [empty]}).swarm("r")
        self.assertEqual(len(none), 0)
        self.assertEqual(none.poses().shape, (0, 4))
        none.set_speeds([], [], where=[])
        with self.assertRaisesRegex(ValueError, "^where, an array of bool, has shape .1,.; for a swarm of 0 robots"):
            none.set_speeds(0, 0, where=[True])


class Looking(InAFolder):
    def test_measures(self):
        world = troupe.Simulation(ROOM)
        measures = troupe.Measures(world, ["displacement:r", {"kind": "neighbours", "name": "near", "radius_m": 9}])
        self.assertEqual(measures.columns, ["displacement_m:r", "near"])
        world.swarm("r").set_speeds(0.5, 0)
        world.run_for(1, lambda _: measures.see())
        self.assertGreater(measures["displacement:r"], 0.1)
        self.assertEqual(measures.values()[0], measures["displacement:r"])
        self.assertEqual(dict(measures), dict(zip(measures.columns, measures.values())))
        self.assertTrue([*measures] == measures.keys() == measures.columns)
        self.assertTrue("near" in measures and "far" not in measures)
        with self.assertRaisesRegex(LookupError, "unknown measure"):
            measures["far"]
        with self.assertRaises(troupe.InputError):
            troupe.Measures(world, ["far"])
        with self.assertRaises(TypeError):
            troupe.Measures(None)
        for wrong, found in ((lambda robots: robots.poses(), r"an array of shape \(9, 4\)"), (lambda robots: None, "None"), (lambda robots: "1", "'1'")):
            with self.assertRaisesRegex(TypeError, f"^the measure <lambda> returned {found}, expected a number$"):
                troupe.Measures(world, [wrong]).values()

    def test_poses_speeds_hits_and_events_can_be_pickled(self):
        world = troupe.Simulation(ROOM)
        robot, events = world.find("r0"), troupe.Events(world)
        robot.set_pose((4.7, 0, 0))
        robot.set_speed(0.5, 0)
        seen = []
        for _ in range(4):
            world.step()
            seen += events.see()
        self.assertEqual(repr(seen), "[<Event stall_begins of r0, east>]")
        for value in (troupe.Pose(1, 2, 3, 4), robot.pose(), robot.speed(), world.cast((0, 4, 0), 9), world.cast((0, 0, 0), 0), *seen):
            other = pickle.loads(pickle.dumps(value))
            self.assertEqual((type(other), repr(other)), (type(value), repr(value)))
        self.assertEqual(pickle.loads(pickle.dumps(seen[0])).id, seen[0].id)
        with self.assertRaisesRegex(TypeError, "cannot pickle"):
            pickle.dumps(world)

    def test_means_are_exact_sums_rounded_once(self):
        world = troupe.Simulation(HOSPITAL, robots=3000)
        swarm, measures = world.swarm(), troupe.Measures(world, ["displacement"])
        before = swarm.poses()
        world.run_for(3)
        measures.see()
        way = swarm.poses() - before
        lengths = np.sqrt(way[:, 0] * way[:, 0] + way[:, 1] * way[:, 1])
        self.assertEqual(measures["displacement"], math.fsum(lengths) / len(lengths))
        # Else the test could not fail. (Python's sum() rounds only once from Python 3.12 on.)
        self.assertNotEqual(math.fsum(lengths), functools.reduce(operator.add, lengths.tolist()))

    def test_recordings(self):
        world = troupe.Simulation(ROOM)
        with skipped_where_lacking():
            with troupe.Recording("run.h5", world, every_s=0.2) as recording:
                world.run_for(1, lambda _: recording.observe())
        self.assertGreater(os.path.getsize("run.h5"), 1000)
        with self.assertRaisesRegex(RuntimeError, r"^observe\(\): the recording is closed: make another one$"):
            recording.observe()
        recording.close()
        with troupe.Recording("two.h5", world) as recording:
            world.reset(seed=99)
            with self.assertRaisesRegex(RuntimeError, "^two.h5: error: the simulation was reset after tick 5"):
                recording.observe()
        with self.assertRaises(troupe.InputError):
            troupe.Recording("run.h5", world)  # the file exists
        for every in (-1, math.nan, math.inf):
            for record in (world.record, lambda file, **options: troupe.Recording(file, world, **options)):
                with self.assertRaisesRegex(ValueError, f"every_s is {every:g}: give a number from 0"):
                    record("other.h5", every_s=every)
        self.assertFalse(os.path.exists("other.h5"))

    def test_a_run_records_itself(self):
        world = troupe.Simulation(ROOM, seed=9)
        self.assertEqual((world.seed, world.resumed_at_tick), (9, None))
        with skipped_where_lacking():
            world.record("own.h5", fields=["pose"], every_s=0.2)
        with self.assertRaisesRegex(RuntimeError, "this run is already being recorded"):
            world.record("other.h5")
        with self.assertRaisesRegex(troupe.InputError, "^run.csv: error: the file would be in the format HDF5"):
            world.save("run.csv")
        world.step(5)
        world.stop_recording()
        self.assertGreater(os.path.getsize("own.h5"), 1000)
        with self.assertRaises(troupe.InputError):
            world.record("own.h5")
        world.record("own.h5", replace=True)
        world.reset()
        world.save("c.h5")
        self.assertEqual(troupe.Simulation.resume("c.h5").resumed_at_tick, 0)
        self.assertRegex(world.hash_log_header(), "^# troupe hash log 1\n# version: ")
        self.assertTrue(world.hash_log_line().startswith(f"0 {world.state_hash():016x} pose="))

    def test_files_that_the_world_was_read_from_are_not_replaced(self):
        inputs = {
            "w.json": b'{"troupe": 1, "floorplans": [{"name": "plan", "bitmap": "plan.png", "size_m": [3, 3, 1]}]}',
            "plan.png": b"P5 3 3 255\n" + bytes(9),
        }
        for name, content in inputs.items():
            pathlib.Path(name).write_bytes(content)
        world = troupe.Simulation("w.json")
        for name, content in inputs.items():
            for write in (
                world.save,
                world.snapshot,
                lambda file: world.record(file, replace=True),
                lambda file: world.replay(file, 1, replace=True),
            ):
                with self.assertRaisesRegex(RuntimeError, f"^{name}: error: cannot be written: "):
                    write(name)
            self.assertEqual(pathlib.Path(name).read_bytes(), content)

    def test_many_are_put_at_once(self):
        world = troupe.Simulation(ROOM)
        world.set_poses([(world.find("r0"), (0, -4.5, 0)), (world.find("cart"), troupe.Pose(1, 4))])
        self.assertEqual(tuple(world.find("r0").pose()), (0, -4.5, 0))
        self.assertEqual(world.find("cart").pose(), troupe.Pose(1, 4))
        with self.assertRaises(ValueError):
            world.set_poses([(world.find("r0"), (0, -4, 0)), (world.find("cart"), (1e9, 0, 0))])
        self.assertEqual(tuple(world.find("r0").pose()), (0, -4.5, 0))

    def test_pictures(self):
        world = troupe.Simulation(ROOM)
        with skipped_where_lacking():
            picture = world.picture(320, 200)
        self.assertEqual((picture.dtype, picture.shape), (np.uint8, (200, 320, 3)))
        self.assertGreater(len(np.unique(picture.reshape(-1, 3), axis=0)), 5)
        blue = (picture == (0x00, 0x72, 0xB2)).all(axis=2)
        self.assertTrue(blue[:, :290].any())  # the robots: the first type has the palette's first colour
        self.assertFalse(((picture[:, :, 0] > 200) & (picture[:, :, 1] < 60)).any())
        self.assertTrue((world.picture(320, 200) == picture).all())
        self.assertTrue((world.picture(320, 200, background="dark")[0, 0] == (27, 29, 34)).all())
        with self.assertRaisesRegex(ValueError, "cannot have the background .transparent."):
            world.picture(320, 200, background="transparent")
        world.snapshot("room.svg", 320, 200, background="transparent")
        self.assertIn("<svg", (self.folder / "room.svg").read_text())
        world.snapshot("room.png", 320, 200)
        self.assertEqual((self.folder / "room.png").read_bytes()[:4], b"\x89PNG")
        side = world.picture(320, 200, camera="perspective", layers="scans", across_m=4)
        self.assertEqual(side.shape, picture.shape)
        self.assertTrue((side != picture).any())
        for option, wrong, text in (
            ("camera", "perspektive", 'unknown camera "perspektive"; known: fit, follow:NAME, follow:all, perspective, top, '
                                      'window (did you mean "perspective"?)'),
            ("layers", "scan", 'unknown layer "scan"; known: beams, '),
            ("background", "pink", 'unknown background "pink"; known: dark, paper, transparent, white'),
        ):
            for draw in (lambda **options: world.snapshot("wrong.png", **options), world.picture):
                with self.subTest(option), self.assertRaisesRegex(troupe.InputError, f"^{option}: error: {re.escape(text)}"):
                    draw(**{option: wrong})
        for size in ((0, 10), (10, -1)):
            with self.assertRaisesRegex(ValueError, "must be 1 or more"):
                world.picture(*size)
        for across_m in (-1, 0, 1e-308, math.nan, math.inf):
            with self.assertRaisesRegex(ValueError, "^across_m is .*: give a finite number, at least 1e-06$"):
                world.picture(16, 16, across_m=across_m)

    def test_other_threads_run_while_a_picture_is_drawn_or_rays_are_cast(self):
        world = troupe.Simulation(ROOM, threads=1)
        team = {"name": "r", "robots": "r", "actions": [{"command": "forward", "low": 0, "high": 1}]}
        batch = troupe.BatchEnv(world, {"copies": 1, "threads": 1, "ticks": 1, "seconds": 9.0, "teams": [team]})
        with skipped_where_lacking():
            world.picture(16, 16)
        for use, look in ((lambda: world.picture(800, 600), lambda: world.tick),
                          (lambda: world.snapshot("room.png", 800, 600), lambda: world.tick),
                          (lambda: world.cast_many(np.full((50000, 4), 0.1), 4), lambda: world.tick),
                          (lambda: batch.picture(0, 800, 600), lambda: batch.copies)):
            refused = []
            user = threading.Thread(target=lambda: [use() for _ in range(10)])
            user.start()
            while user.is_alive():
                try:
                    look()
                except RuntimeError as error:
                    refused.append(str(error))
                time.sleep(0.001)
            user.join()
            self.assertRegex(" ".join(refused), "is being (used|stepped) by another thread")

    def test_other_threads_run_while_files_are_written_and_worlds_are_copied_or_reset(self):
        world = troupe.Simulation(HOSPITAL, robots=2000, threads=1)
        team = {"name": "r", "robots": "minibot", "actions": [{"command": "forward", "low": 0, "high": 1}]}
        recordings = []
        calls = {
            "save": lambda: world.save("c.h5"),
            "record": lambda: world.record("own.h5", fields=["all"], replace=True),
            "reset": lambda: [world.reset(seed) for seed in range(20)],  # one takes less than a millisecond
            "Recording": lambda: recordings.append(troupe.Recording("other.h5", world, ["all"], replace=True)),
            "BatchEnv": lambda: troupe.BatchEnv(world, {"copies": 2, "threads": 1, "ticks": 1, "seconds": 9.0, "teams": [team]}),
        }
        with skipped_where_lacking():
            world.save("c.h5")
        present, seen = [None], set()

        def call_all():
            for _ in range(20):
                for name, call in calls.items():
                    present[0] = name
                    call()
                present[0] = None
                world.stop_recording()
                recordings.pop().close()
                if seen == set(calls):
                    return

        user = threading.Thread(target=call_all)
        user.start()
        while user.is_alive():
            name = present[0]
            try:
                world.tick  # raises only during one of the calls: between them, the simulation is free
            except RuntimeError:
                if name is not None and name == present[0]:
                    seen.add(name)
        user.join()
        self.assertEqual(seen, set(calls))

    def test_statistics(self):
        world = troupe.Simulation(ROOM)
        world.step(2)
        statistics = world.statistics()
        self.assertEqual((statistics["robots"], statistics["ticks"]), (7, 2))
        self.assertGreater(statistics["beams"], 0)


if __name__ == "__main__":
    unittest.main()
