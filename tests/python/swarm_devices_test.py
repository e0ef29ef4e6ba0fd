"""Tests of readings and commands of the devices of all robots as arrays: Swarm.readings, command, say and heard."""

import os
import pathlib
import unittest

import numpy as np
import troupe
from support import ROOM, calls_of

PLUGINS = pathlib.Path(os.environ["PYTHONPATH"].split(":")[0]).parents[2] / "plugins" / "plugins"

TALKERS = {
    "troupe": 1,
    "types": {
        "bot": {
            "size_m": [0.2, 0.2, 0.2],
            "drive": {"kind": "diff"},
            "sensors": [{"name": "radio", "kind": "radio", "range_m": 3, "payload": 8, "most_heard": 3}],
            "devices": [{"name": "lamp", "kind": "led"}],
        }
    },
    "populations": [
        {"name": "r", "type": "bot", "count": 6, "place": {"rule": "grid", "region_m": [[0, 0], [0, 10]], "pitch_m": 2}}
    ],
}


class Devices(unittest.TestCase):
    def setUp(self):
        self.world = troupe.Simulation(TALKERS)
        self.swarm = self.world.swarm("r")

    def test_readings_are_arrays_in_the_order_of_the_swarm(self):
        self.world.step()
        self.assertEqual(self.swarm.readings("count").shape, (6,))
        self.assertEqual(self.swarm.readings("count").dtype, np.uint32)
        self.assertEqual(self.swarm.readings("range", "radio").shape, (6, 3))
        self.assertEqual(self.swarm.readings("payload", "radio").shape, (6, 24))
        for i, name in enumerate(self.swarm.names):
            np.testing.assert_array_equal(
                self.swarm.readings("shown_color", "lamp")[i], self.world.find(name).readings("shown_color"))
        room = troupe.Simulation(ROOM)
        room.step()
        np.testing.assert_array_equal(room.swarm("r").readings("ranges"), room.swarm("r").ranges())

    def test_commands_take_numbers_and_arrays(self):
        red = np.linspace(0, 1, 6, dtype=np.float32)
        self.swarm.command("lamp", shows=1, red=red, green=0.5, where=np.arange(6) < 5)
        now = self.swarm.commands("lamp")
        np.testing.assert_array_equal(now["red"][:5], red[:5])
        self.assertEqual(now["shows"].tolist(), [1, 1, 1, 1, 1, 0])
        self.world.step(2)
        shown = self.swarm.readings("shown_color", "lamp")
        np.testing.assert_array_equal(shown[:5], np.stack([red[:5], np.full(5, 0.5), np.zeros(5)], 1))
        np.testing.assert_array_equal(shown[5], [1, 1, 1])

    def test_messages_are_bytes_or_arrays(self):
        self.swarm.say(np.arange(6, dtype="<f4") / 2)
        self.world.step(2)
        heard, there = self.swarm.heard("<f4")
        self.assertEqual(heard.shape, (6, 3))
        self.assertEqual(there.sum(axis=1).tolist(), [1, 2, 2, 2, 2, 1])
        for i in range(6):
            self.assertEqual(sorted(heard[i][there[i]]), [n / 2 for n in (i - 1, i + 1) if 0 <= n < 6])
        self.assertFalse(self.swarm.heard("u1")[1].any())  # because the messages have another length
        for message in (b"hello", bytearray(b"adieu"), memoryview(b"again")):
            self.swarm.say(message)
            self.world.step(2)
            heard, there = self.swarm.heard("S5")
            self.assertEqual(set(heard[there].tolist()), {bytes(message)})
        self.swarm.say([b"hi", bytearray(b"hello"), memoryview(b""), b"a\0", b"hi", b"hello"])
        self.assertEqual(self.swarm.commands("radio")["length"].tolist(), [2, 5, 0, 2, 2, 5])
        self.world.step(2)
        heard, there = self.swarm.heard("S2")
        self.assertEqual(set(heard[there].tolist()), {b"hi", b"a"})
        self.swarm.command("radio", mode=1, length=np.arange(6), payload=[bytearray(b"ab"[: i % 3]) for i in range(6)])
        self.world.step(2)
        self.assertEqual(self.swarm.readings("length")[0, 0], 1)
        np.testing.assert_array_equal(self.swarm.readings("payload")[1][:3], [0, 0, 0])
        pairs = np.zeros(6, dtype=[("heading", "<f4"), ("hops", "<u2")])
        pairs["hops"] = np.arange(6)
        self.swarm.say(pairs)
        self.world.step(2)
        heard, there = self.swarm.heard(pairs.dtype)
        self.assertEqual(heard["hops"][0][there[0]].tolist(), [1])
        self.swarm.command("radio", mode=2)
        self.world.step(2)
        self.assertEqual(self.swarm.readings("count").tolist(), [0] * 6)

    def test_without_a_name_the_first_radio_is_used_unless_another_is_called_radio(self):
        def radio(name, channel):
            return {"name": name, "kind": "radio", "channel": channel, "payload": 8, "most_heard": 3}

        for names, used in ((["ear"], "ear"), (["ear", "mouth"], "ear"), (["ear", "radio"], "radio")):
            finder = {"name": "finder", "kind": "fiducial"}  # its readings have the field `count`, too
            bot = {**TALKERS["types"]["bot"], "fiducial_return": 1,
                   "sensors": [finder] + [radio(name, f"channel {name}") for name in names]}
            world = troupe.Simulation({**TALKERS, "types": {"bot": bot}})
            swarm = world.swarm("r")
            swarm.say(b"hello")
            self.assertEqual([name for name in names if swarm.commands(name)["length"].any()], [used])
            world.step(2)
            for given, there in zip(swarm.heard("S5"), swarm.heard("S5", used)):
                np.testing.assert_array_equal(given, there)
            self.assertTrue(swarm.heard("S5")[1].any())
        silent = troupe.Simulation({**TALKERS, "types": {"bot": {**TALKERS["types"]["bot"], "sensors": []}}}).swarm()
        empty = troupe.Simulation(TALKERS, robots={"r": 0}).swarm("r")
        for swarm, error, text in ((silent, LookupError, 'has no device .*"radio"'),
                                   (empty, RuntimeError, "a swarm without robots has no devices")):
            for use in (lambda: swarm.say(b"hello"), lambda: swarm.heard("S5")):
                with self.assertRaisesRegex(error, text):
                    use()

    def test_what_is_wrong_changes_nothing(self):
        for error, text, call in (
            (LookupError, r'device "radio" of "r0": unknown field "cuont"; known: ', lambda: self.swarm.readings("cuont", "radio")),
            (LookupError, 'did you mean "lamp"', lambda: self.swarm.command("lump", red=1)),
            (LookupError, 'device "lamp": unknown command field "rde"; known: ',
             lambda: self.swarm.command("lamp", red=1, rde=1)),
            (ValueError, '"red" has shape .5,.; for a swarm of 6 robots give one number, or one per robot',
             lambda: self.swarm.command("lamp", green=1, red=np.zeros(5))),
            (ValueError, '"red" has shape .1,.; for a swarm of 6 robots give one number, or one per robot',
             lambda: self.swarm.command("lamp", green=1, red=[0.5])),
            (ValueError, '"payload" has shape .1,.; for a swarm of 6 robots give 8 numbers, or 8 per robot',
             lambda: self.swarm.command("radio", payload=[b"a"])),
            (ValueError, '"shows" has the type uint8, which cannot represent 1.5',
             lambda: self.swarm.command("lamp", red=1, shows=1.5)),
            (ValueError, '"shows" has the type uint8, which cannot represent 1180591620717411303424',
             lambda: self.swarm.command("lamp", red=1, shows=2**70)),
            (ValueError, '"red" has the type float32, which cannot represent 1e.300', lambda: self.swarm.command("lamp", green=1, red=1e300)),
            (TypeError, "^shows: found None: give numbers$", lambda: self.swarm.command("lamp", red=1, shows=None)),
            (ValueError, '^"red" of row 2 is nan: give a number$',
             lambda: self.swarm.command("lamp", green=1, red=[0, 0, np.nan, 0, 0, 0])),
            (TypeError, "^red: found '0.5': give numbers$", lambda: self.swarm.command("lamp", green=1, red="0.5")),
            (ValueError, "a message of 16 bytes is longer than the payload",
             lambda: self.swarm.say(np.zeros((6, 2)))),
            (ValueError, "message has shape .5,.", lambda: self.swarm.say(np.zeros(5))),
            (ValueError, "message has shape .1,.; for a swarm of 6 robots give a bytes object, or a list of one such object per robot",
             lambda: self.swarm.say([b"a"])),
            (ValueError, "^a message of 9 bytes is longer than the payload", lambda: self.swarm.say([b"a"] * 5 + [b"a" * 9])),
            (ValueError, "^a message of 1000 bytes is longer than the payload", lambda: self.swarm.say(b"a" * 1000)),
            (ValueError, '"payload" takes at most 8 bytes, found 9', lambda: self.swarm.command("radio", payload=b"a" * 9)),
            (TypeError, "^red: found b'a': give numbers$", lambda: self.swarm.command("lamp", green=1, red=b"a")),
            (ValueError, "^message: found the text 'hello': give bytes, as in text.encode", lambda: self.swarm.say("hello")),
            (ValueError, "^message: found the text array", lambda: self.swarm.say(np.array(["a"] * 6))),
            (ValueError, "message: the elements of the array are Python objects",
             lambda: self.swarm.say(np.array([object()] * 6))),
            (ValueError, "message: the elements of the array are Python objects",
             lambda: self.swarm.say(np.zeros(6, [("text", "O")]))),
            (ValueError, "must have 1 to", lambda: self.swarm.heard("S9")),
            (ValueError, "where, an array of float64, has shape", lambda: self.swarm.command("lamp", red=1, where=np.zeros(6))),
        ):
            with self.subTest(text), self.assertRaisesRegex(error, text):
                call()
        self.assertEqual(self.swarm.commands("lamp")["red"].tolist(), [0] * 6)
        self.assertFalse(self.swarm.commands("radio")["payload"].any())


class Talkers(unittest.TestCase):
    """The rule of tests/plugins/talker.cpp, computed in NumPy between ticks.

    The states differ: a plug-in sees the estimated pose before the motion of its tick.
    """

    def world(self, count, **controller):
        bot = {
            "disc": {"radius_m": 0.1, "height_m": 0.1, "corners": 8},
            "drive": {"kind": "diff"},
            "sensors": [{"name": "radio", "kind": "radio", "range_m": 1.2, "payload": 8, "most_heard": 16}],
            "devices": [{"name": "lamp", "kind": "led"}],
            **controller,
        }
        place = {"rule": "grid", "pitch_m": 0.5, "jitter_m": 0.1, "heading": "random", "region_m": [[0, 0], [49.9, 50]]}
        return {"troupe": 1, "types": {"bot": bot},
                "populations": [{"name": "r", "type": "bot", "count": count, "place": place}]}

    @staticmethod
    def talk(swarm):
        heading = swarm.estimates()[:, 3]
        heard, there = swarm.heard("2f4")
        mean = np.where(there[:, :, np.newaxis], heard, 0)
        x, y = troupe.math.ordered_sum(mean[:, :, 0]), troupe.math.ordered_sum(mean[:, :, 1])
        count = there.sum(axis=1)
        turn = troupe.math.wrap_angle(troupe.math.atan2(y, x) - heading)
        swarm.set_speeds(0.2, np.where(count > 0, turn, 0.0))
        swarm.say(np.stack([troupe.math.cos(heading), troupe.math.sin(heading)], axis=1).astype("f4"))
        swarm.command("lamp", shows=1, red=count.astype("f4") / np.float32(16), green=0.25, blue=0.25)

    def test_the_plugin_and_numpy_show_the_same_first_counts(self):
        plugin = troupe.Simulation(self.world(400, controller={"kind": "talker"}), plugin_path=[PLUGINS], threads=1)
        numpy = troupe.Simulation(self.world(400), threads=1)
        swarm = numpy.swarm()
        for _ in range(2):
            self.talk(swarm)
            numpy.step()
        plugin.step(3)  # it says its first message in the first tick, and not before it
        shown = [world.swarm().readings("shown_color", "lamp") for world in (numpy, plugin)]
        np.testing.assert_array_equal(*shown)
        self.assertGreater(len(np.unique(shown[0][:, 0])), 3)

    # A bool of another value is undefined behaviour in the device, and a checkpoint with it cannot be resumed.
    def test_a_bool_in_a_command_is_0_or_1(self):
        class blower(troupe.Controller):
            def decide(self, robots):
                robots.command("horn", pitch=5, blows=blows)

        world = {"troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
                                                "devices": [{"name": "horn", "kind": "talker:horn"}]}},
                 "models": [{"name": "r", "type": "bot"}]}
        free = troupe.Simulation(world, plugin_path=PLUGINS, threads=1)
        steered = troupe.Simulation(world, plugin_path=PLUGINS, threads=1, controllers=blower)
        robot, swarm = free.find("r"), free.swarm()
        for blows in (0, 1, True, np.uint8(1), 1.0):
            robot.command("horn", pitch=1, blows=blows)
            swarm.command("horn", pitch=1, blows=blows)
            steered.step()
            self.assertEqual(swarm.commands("horn")["blows"].tolist(), [blows])
            self.assertEqual(steered.swarm().commands("horn")["blows"].tolist(), [blows])
        for blows in (2, 255, -1, 0.5):
            for call in (robot.command, swarm.command):
                with self.subTest(blows=blows, call=call), self.assertRaisesRegex(
                        ValueError, f'"blows" has the type bool, which cannot represent {blows}$'):
                    call("horn", pitch=5, blows=blows)
            self.assertEqual(robot.command("horn"), {"pitch": 1, "blows": 1}, "no field has changed")
            with self.assertRaisesRegex(troupe.StepError, f'"blows" has the type bool, which cannot represent {blows}$'):
                steered.step()
            steered.reset()

    def test_python_is_called_as_often_for_a_thousand_robots_as_for_ten(self):
        calls = []
        for count in (10, 1000):
            world = troupe.Simulation(self.world(count), threads=1)
            swarm = world.swarm()
            for _ in range(2):  # the first calls may fill caches
                self.talk(swarm)
                world.step()
            calls.append(calls_of(lambda: self.talk(swarm)))
        self.assertEqual(*calls)
        self.assertGreater(calls[0], 20)


if __name__ == "__main__":
    unittest.main()
