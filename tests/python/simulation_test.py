"""The simulation as Python sees it."""

import copy
import gc
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np
import troupe
from support import HOSPITAL, ROOM, ROOT, InAFolder


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
        self.assertRegex(findings[0], r'^made\.json:\d+: error: /types/bot/drive/kind: unknown drive "hover"; known: ')
        self.assertIn("/types/cart/size_m", findings[1])
        self.assertEqual(str(caught.exception), "\n".join(findings))
        with self.assertRaisesRegex(troupe.InputError, "^none.world: error: there is no such file$"):
            troupe.Simulation("none.world")
        with self.assertRaisesRegex(ValueError, 'unknown ranging "gird"; known: exact, grid'):
            troupe.Simulation(ROOM, ranging="gird")
        with self.assertRaises(ValueError):  # JSON has no such number
            troupe.Simulation({**ROOM, "tick_s": float("nan")})
        with self.assertRaises(TypeError):
            troupe.Simulation(7)
        with self.assertRaises(TypeError):
            troupe.Simulation(ROOM, seed=-1)

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
        with self.assertRaisesRegex(ValueError, "give a time in seconds"):
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
        try:
            world.save("middle.h5")
        except RuntimeError as error:
            self.skipTest(str(error))
        world.step(10)
        later = troupe.Simulation.resume("middle.h5", threads=2)
        self.assertEqual(later.state_hash(), middle)
        later.step(10)
        self.assertEqual(later.state_hash(), world.state_hash())
        (self.folder / "bad.h5").write_bytes(b"\x89HDF")
        with self.assertRaisesRegex(troupe.InputError, "^bad.h5: error: "):
            troupe.Simulation.resume("bad.h5")

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
        self.assertIn("is being stepped by another thread", refused[0])
        self.assertEqual(world.tick, 300)

    def test_control_c_ends_it_between_two_ticks(self):
        code = f"""
import troupe
world = troupe.Simulation({str(HOSPITAL)!r}, robots=50)
print("begun", flush=True)
try:
    world.run_for(1e9)
except KeyboardInterrupt:
    hash = world.state_hash()
    ticks = world.tick
    world.reset()
    world.step(ticks)
    print("same" if world.state_hash() == hash else "other")
"""
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "begun\n")
            time.sleep(0.3)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.communicate(timeout=60)[0], "same\n")

    def test_a_speed_that_is_no_number_is_told_with_its_robot(self):
        world = troupe.Simulation(ROOM)
        world.find("r3").set_speed(float("nan"), 0)
        with self.assertRaisesRegex(troupe.StepError, '"r3"') as caught:
            world.step()
        self.assertIsInstance(caught.exception, RuntimeError)
        world.reset()
        world.step()
        self.assertEqual(world.tick, 1)


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
        self.assertIsNone(world.spawn("r", (0, -4.5, 0)))  # taken
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

    def test_of_one_name_are_told_apart_by_their_types(self):
        world = troupe.Simulation(ROOM)
        world.step()
        with self.assertRaisesRegex(ValueError, "robots of 2 types: say which: .*bot"):
            world.table("ranger/eye")
        eyes = world.table("ranger/eye", "bot")
        self.assertEqual(eyes.type, "bot")
        ranges = eyes["ranges"]
        self.assertEqual((ranges.dtype, ranges.shape), (np.float32, (8, 3)))
        bots = world.swarm("bot")
        np.testing.assert_array_equal(ranges[np.argsort(eyes.ids)], bots.ranges())
        with self.assertRaisesRegex(LookupError, 'unknown component "ranger/ear"; known: '):
            world.table("ranger/ear")
        self.assertIn("stall", [table.component for table in world.tables()])

    def test_keep_their_world_alive(self):
        world = troupe.Simulation(ROOM)
        world.step()
        views = [world.table("pose")["x"], world.table("pose").ids, world.find("cart").ranges()]
        swarm, copies = world.swarm(), [np.array(view) for view in views]
        del world
        gc.collect()
        for _ in range(20):
            troupe.Simulation(ROOM).step()  # would lie where the old one lay
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
        ranges[:] = -1  # the caller's own
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
        poses = self.bots.poses()
        poses[:6] = np.column_stack([np.arange(6) - 3, np.full(6, -4.5), np.zeros(6), np.zeros(6)])
        self.bots.set_poses(poses, where=np.arange(8) < 6)
        np.testing.assert_array_equal(self.bots.poses()[:6], poses[:6])
        self.bots.go_to(0, np.linspace(-3, 3, 8), 0)
        self.world.step()
        self.assertNotEqual(self.bots.speeds()[0].tolist(), [0, 0, 0])

    def test_shapes_that_do_not_fit_are_told(self):
        for wrong in (np.zeros(7), np.zeros((8, 1)), np.zeros((8, 8))):
            with self.assertRaisesRegex(ValueError, "turn has shape .*; for a swarm of 8 robots give one number, or one for each"):
                self.bots.set_speeds(0, wrong)
        with self.assertRaisesRegex(ValueError, "where, of int64, has shape .8,.; .* give one bool for each"):
            self.bots.set_speeds(0, 0, where=np.arange(8))
        with self.assertRaisesRegex(ValueError, "poses has shape .8, 3."):
            self.bots.set_poses(np.zeros((8, 3)))
        for wrong in ("fast", None):
            with self.assertRaises((TypeError, ValueError)):
                self.bots.set_speeds(wrong, 0)
        with self.assertRaisesRegex(ValueError, "different rangers"):
            self.world.swarm().ranges("eye")
        with self.assertRaisesRegex(LookupError, 'unknown type or population of robots "bit".*did you mean "bot"'):
            self.world.swarm("bit")
        with self.assertRaisesRegex(ValueError, "outside the world's bounds"):
            self.bots.set_poses(np.full((8, 4), 1e9))


class Looking(InAFolder):
    def test_measures(self):
        world = troupe.Simulation(ROOM)
        measures = troupe.Measures(world, ["displacement:r", {"kind": "neighbours", "name": "near", "radius_m": 9}])
        self.assertEqual(measures.columns, ["displacement_m:r", "near"])
        world.swarm("r").set_speeds(0.5, 0)
        world.run_for(1, lambda _: measures.see())
        self.assertGreater(measures["displacement:r"], 0.1)
        self.assertEqual(measures.values()[0], measures["displacement:r"])
        with self.assertRaisesRegex(LookupError, "unknown measure"):
            measures["far"]
        with self.assertRaises(troupe.InputError):
            troupe.Measures(world, ["far"])
        with self.assertRaises(TypeError):
            troupe.Measures(None)

    def test_recordings(self):
        world = troupe.Simulation(ROOM)
        try:
            with troupe.Recording("run.h5", world, every_s=0.2) as recording:
                world.run_for(1, lambda _: recording.observe())
        except RuntimeError as error:
            self.skipTest(str(error))
        self.assertGreater(os.path.getsize("run.h5"), 1000)
        with self.assertRaises(troupe.InputError):
            troupe.Recording("run.h5", world)  # is there

    def test_pictures(self):
        world = troupe.Simulation(ROOM)
        try:
            picture = world.picture(320, 200)
        except RuntimeError as error:
            self.skipTest(str(error))
        self.assertEqual((picture.dtype, picture.shape), (np.uint8, (200, 320, 3)))
        self.assertGreater(len(np.unique(picture.reshape(-1, 3), axis=0)), 5)
        red = (picture[:, :, 0] > 200) & (picture[:, :, 1] < 60) & (picture[:, :, 2] < 60)
        self.assertTrue(red[:, :290].any())  # the robots
        world.snapshot("room.png", 320, 200)
        self.assertEqual((self.folder / "room.png").read_bytes()[:4], b"\x89PNG")
        for size in ((0, 10), (10, -1)):
            with self.assertRaisesRegex(ValueError, "give 1 or more"):
                world.picture(*size)

    def test_statistics(self):
        world = troupe.Simulation(ROOM)
        world.step(2)
        statistics = world.statistics()
        self.assertEqual((statistics["robots"], statistics["ticks"]), (7, 2))
        self.assertGreater(statistics["beams"], 0)


if __name__ == "__main__":
    unittest.main()
