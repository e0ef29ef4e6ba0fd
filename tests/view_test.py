#!/usr/bin/env python3
"""Tests `troupe view`: operates its page in a headless Chromium with mouse and keyboard, and attacks its port.

    view_test.py TROUPE [PICTURES]    PICTURES: folder for screenshots
"""

import base64
import contextlib
import importlib.util
import json
import os
import random
import resource
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from tests.support.chromium import Page, Picture, find  # noqa: E402
from tests.support.websocket import WAIT_S, Refused, Socket, request  # noqa: E402

TROUPE = None
PICTURES = None
PROGRAM = find()
SIZE = (1280, 720)
HAS_IPV6 = os.path.exists("/proc/net/if_inet6") and "00000000000000000000000000000001" in Path("/proc/net/if_inet6").read_text()

WORLD = {
    "troupe": 1, "title": "Two rooms", "seed": 3, "bounds_m": [[-6, -4], [6, 4]],
    "types": {
        "runner": {"size_m": [0.5, 0.4, 0.3], "drive": {"kind": "diff", "velocity_max_x_mps": 1},
                   "sensors": [{"name": "eye", "kind": "ranger",
                                "transducers": [{"range_max_m": 3, "samples": 9, "fov_deg": 180}]}],
                   "controller": {"kind": "wander"}},
        "wall": {"size_m": [0.2, 6, 0.6]},
    },
    "models": [
        {"name": "red", "type": "runner", "color": [0.8, 0.1, 0.1], "pose": {"x_m": -3, "y_m": -1}},
        {"name": "blue", "type": "runner", "color": [0.1, 0.2, 0.8], "pose": {"x_m": 2, "y_m": 1.5, "heading_deg": 90}},
        {"name": "wall", "type": "wall", "color": "gray40", "pose": {"x_m": 0, "y_m": 1}},
    ],
}


YARD = {
    "troupe": 1, "title": "Yard", "seed": 5, "bounds_m": [[-8, -8], [8, 8]],
    "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff", "velocity_max_x_mps": 1},
                      "sensors": [{"name": "eye", "kind": "ranger",
                                   "transducers": [{"range_max_m": 2, "samples": 9, "fov_deg": 180}]},
                                  {"name": "ear", "kind": "radio", "range_m": 3, "beacon": True}],
                      "devices": [{"name": "lamp", "kind": "led"}], "controller": {"kind": "wander"}}},
    "populations": [{"name": "b", "type": "bot", "count": 30, "reserve": 300, "place": {"rule": "uniform"}}],
}


# Scripts that change the WebSockets of a page. A test passes them to InABrowser.opened().
REFUSED_ONCE = """
    const Real = WebSocket;
    let refusals = 1;
    window.WebSocket = function (address) {
      if (refusals-- <= 0) return new Real(address);
      const refused = { send() {} };
      setTimeout(() => (refused.onopen(), refused.onclose({ code: 1013, reason: "at most 16 viewers can be connected" })));
      return refused;
    };
    window.WebSocket.OPEN = Real.OPEN;
"""
KEPT_SOCKETS = """
    const Real = WebSocket;
    window.sockets = [];
    window.WebSocket = function (address) { return sockets[sockets.push(new Real(address)) - 1]; };
    window.WebSocket.OPEN = Real.OPEN;
"""
SLOW_ANSWERS = """
    const { set } = Object.getOwnPropertyDescriptor(WebSocket.prototype, "onmessage");
    Object.defineProperty(WebSocket.prototype, "onmessage", { set(take) {
      const isAnswer = ({ data }) => typeof data === "string" && JSON.parse(data).type === "done";
      set.call(this, (event) => (isAnswer(event) ? setTimeout(() => take(event), 3000) : take(event)));
    } });
"""
# A command that is not finite: the program sends such numbers as null.
NULL_COMMANDS = """
    const { parse } = JSON;
    JSON.parse = (text) => {
      const message = parse(text);
      if (message?.inspected?.commands?.lamp) message.inspected.commands.lamp.red = [null];
      return message;
    };
"""


class View:
    """A running `troupe view`."""

    def __init__(self, *arguments, checkpoint_s=None, world=WORLD, environment=None):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = Path(self.temporary.name)
        self.world = self.folder / "rooms.json"
        self.world.write_text(json.dumps(world))
        shown = self.world
        if checkpoint_s is not None:
            shown = self.folder / "c.h5"
            subprocess.run([TROUPE, "run", self.world, "--set", "/mortal=true", "--for", str(checkpoint_s), "--checkpoint", shown,
                            "--quiet"], check=True)
        self.errors = open(self.folder / "errors", "w+")
        self.process = subprocess.Popen([TROUPE, "view", shown, "--out", self.folder, *map(str, arguments)],
                                        stdout=subprocess.PIPE, stderr=self.errors, text=True,
                                        env={**os.environ, **(environment or {})})
        lines = {}
        while "session" not in lines:
            line = self.process.stdout.readline()
            if not line:
                raise RuntimeError(self.said())
            if line.startswith("  "):
                name, value = line.strip().rsplit(None, 1)
                lines[name.strip()] = value
        self.address, self.looking, self.session = lines["view"], lines["read-only"], Path(lines["session"])
        self.port = int(self.address.rsplit(":", 1)[1].split("/")[0])
        self.token, self.look_token = (text.split("#")[1] for text in (self.address, self.looking))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()
        self.errors.close()
        self.temporary.cleanup()

    def said(self):
        return (self.folder / "errors").read_text()

    def open(self, token=None):
        viewer = Socket(self.port)
        viewer.send(token or self.token)
        viewer.hello = viewer.receive()
        return viewer

    def end(self):
        """Ends the program as Ctrl-C does, and returns the last line of its output: a line of the hash log."""
        self.process.send_signal(signal.SIGINT)
        printed = self.process.stdout.read()
        assert self.process.wait(WAIT_S) == 3, (self.process.returncode, self.said())
        return printed.strip().split("\n")[-1]

    def replayed(self, *arguments, command=("run", "rooms.json"), session=None):
        """Runs the world with the session and returns the lines of the hash log by tick."""
        log = self.folder / "replay.log"
        log.unlink(missing_ok=True)  # a resumed run would continue it
        subprocess.run([TROUPE, command[0], self.folder / command[1], "--session", session or self.session, "--hash-log", log, "--quiet",
                        *map(str, arguments)], check=True)
        lines = [line for line in log.read_text().split("\n") if line and not line.startswith("#")]
        return {int(line.split()[0]): line for line in lines}


class Steered(unittest.TestCase):
    def test_a_session_is_repeated_to_the_same_bits(self):
        with View("--rate", 0, "--spare", 2) as view, view.open() as viewer:
            self.assertTrue(viewer.hello["may_steer"])
            self.assertEqual(viewer.hello["populations"], [])  # neither of the two robots belongs to a population
            shown = []
            for act in [{"do": "hold", "robot": "red", "speed": [0.5, 0, 0.3]}, {"do": "move", "robot": "blue", "pose": [3, -2, 0, 1]},
                        {"do": "disable", "robot": "blue"}, {"do": "release", "robot": "red"}, {"do": "remove", "robot": "red"}]:
                self.assertEqual(viewer.ask(**act)["type"], "done", act)
                viewer.ask(do="step", ticks=20)
                state = viewer.state()
                while state["playing"] or not state["line"]:
                    state = viewer.state()
                shown.append(state["line"])
            self.assertGreater(len({line.split()[0] for line in shown}), 4)
            last = view.end()
            for threads in (1, 2, 3):
                log = view.replayed("--spare", 2, "--threads", threads)
                for line in [*shown, last]:
                    self.assertEqual(log[int(line.split()[0])], line)
            self.assertEqual(max(log), int(last.split()[0]), "the run ends where the session did")
            refused = subprocess.run([TROUPE, "run", view.world, "--session", view.session], capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2)
            self.assertIn("rooms.session.jsonl:1: error: this run has other options than the run of the session: spare is 2 in the session, but not given in this run", refused.stderr)

    def test_a_checkpoint_is_taken_up_and_its_session_repeated(self):
        with View("--rate", 0, checkpoint_s=2) as view, view.open() as viewer:
            self.assertEqual(viewer.ask(do="move", robot="blue", pose=[3, -2, 0, 1])["type"], "done")
            self.assertEqual(viewer.ask(do="disable", robot="red")["type"], "done")
            last = view.end()
            log = view.replayed(command=("resume", "c.h5"))
            self.assertEqual(log[int(last.split()[0])], last)
            refused = subprocess.run([TROUPE, "view", view.folder / "c.h5", "--seed", "7"], capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2)
            self.assertIn("c.h5: error: --seed, --raytracer, --robots and --spare are only for world files", refused.stderr)
            refused = subprocess.run([TROUPE, "run", view.world, "--set", "/mortal=true", "--session", view.session],
                                     capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2)
            self.assertIn("rooms.session.jsonl:1: error: the session began at tick 20, from a checkpoint", refused.stderr)

    def test_open_needs_a_folder_for_temporary_files(self):
        with tempfile.TemporaryDirectory() as folder:
            world = Path(folder) / "w.json"
            world.write_text('{"troupe": 1}')
            refused = subprocess.run([TROUPE, "view", world, "--open", "--out", folder], capture_output=True, text=True,
                                     env={**os.environ, "TMPDIR": folder + "/none"})
            self.assertEqual(refused.returncode, 1)
            self.assertIn(f"troupe view: error: --open needs a temporary file, but the folder {folder}/none cannot be used: ",
                          refused.stderr)
            self.assertIn("set the environment variable TMPDIR to an existing folder", refused.stderr)

    def test_the_browser_gets_no_socket_and_a_session_of_its_own(self):
        with tempfile.TemporaryDirectory() as folder:
            opener = Path(folder) / "xdg-open"
            opener.write_text(f"#!/bin/sh\nls -l /proc/$$/fd > {folder}/part\necho session $(cut -d ' ' -f 6 /proc/$$/stat) $$ >> {folder}/part\n"
                              f"mv {folder}/part {folder}/opened\n")
            opener.chmod(0o755)
            with View("--open", environment={"PATH": f"{folder}:{os.environ['PATH']}"}):
                opened = Path(folder) / "opened"
                until = time.monotonic() + WAIT_S
                while not opened.exists() and time.monotonic() < until:
                    time.sleep(0.02)
                said = opened.read_text()
        self.assertEqual([line for line in said.splitlines() if "socket:" in line and int(line.split(" -> ")[0].split()[-1]) > 2], [])
        session, process = said.split("session")[1].split()
        self.assertEqual(session, process)

    def test_a_view_without_an_address_begins_no_session(self):
        with View() as view:
            before = sorted(view.folder.iterdir())
            refused = subprocess.run([TROUPE, "view", view.world, "--out", view.folder, "--port", str(view.port)],
                                     capture_output=True, text=True)
            self.assertNotEqual(refused.returncode, 0)
            self.assertIn(str(view.port), refused.stderr)
            self.assertEqual(sorted(view.folder.iterdir()), before)

    def test_a_step_is_a_tick(self):
        with View() as view, view.open() as viewer:
            viewer.ask(do="pause")
            state = viewer.state()
            while state["playing"]:
                state = viewer.state()
            for _ in range(3):
                tick = state["tick"]
                viewer.ask(do="step")
                while state["playing"] or state["tick"] == tick:
                    state = viewer.state()
                self.assertEqual(state["tick"], tick + 1)

    def test_a_slow_run_pauses_at_once(self):
        with View("--rate", 0.001, world={**WORLD, "tick_s": 10}) as view, view.open() as viewer:  # a tick takes 10,000 s
            viewer.ask(do="pause")
            self.assertTrue(any(not viewer.state()["playing"] for _ in range(100)), "100 pictures later, the run is not paused")

    def test_a_viewer_that_goes_away_releases_what_it_drove(self):
        with View("--rate", 0) as view:
            with view.open() as other:
                with view.open() as viewer:
                    self.assertEqual(viewer.ask(do="hold", robot="red", speed=[0, 0, 1])["type"], "done")
                    self.assertIn("another viewer drives", other.ask(do="hold", robot="red", speed=[0, 0, 1])["reason"])
                until = time.monotonic() + WAIT_S
                while other.ask(do="hold", robot="red", speed=[0, 0, 0])["type"] == "refused" and time.monotonic() < until:
                    time.sleep(0.02)
            view.end()
            acts = [json.loads(line)["do"] for line in view.session.read_text().split("\n")[1:] if line]
            self.assertEqual(acts[:3], ["hold", "release", "hold"])
            self.assertEqual(max(view.replayed()), json.loads(view.session.read_text().split("\n")[-2])["tick"])

    def test_what_a_kill_leaves_is_repeated(self):
        with View("--rate", 0) as view, view.open() as viewer:
            for x in (-3, -4, -2):
                viewer.ask(do="move", robot="red", pose=[x, -2, 0, 0])
            viewer.ask(do="pause")
            state = viewer.state()
            while state["playing"] or not state["line"]:
                state = viewer.state()
            view.process.kill()
            tick = int(state["line"].split()[0])
            log = view.replayed("--for", tick * viewer.hello["tick_s"])
            self.assertEqual(log[tick], state["line"])

    def test_a_viewer_that_does_not_read_holds_nothing_up(self):
        with View("--rate", 0) as view, view.open() as lazy, view.open() as viewer:
            before = viewer.state()["tick"]
            for _ in range(100):
                viewer.state()
            self.assertGreater(viewer.state()["tick"], before)
            lazy.socket.settimeout(1)
            pictures = 0
            try:
                while True:
                    pictures += isinstance(lazy.receive(), bytes)
            except (TimeoutError, ConnectionError):
                pass  # on a slow machine, the server has disconnected it, because it has not answered for 30 s
            self.assertEqual(pictures, 2, "so many are on their way at most")

    def test_it_ends_while_viewers_send(self):
        for _ in range(10):
            with View("--rate", 0) as view, view.open() as viewer:
                message = json.dumps({"do": "drawn", "with": [1] * 15000})  # takes the server a while to parse

                def flood():
                    try:
                        while True:
                            viewer.send(message)
                    except OSError:
                        pass
                flooding = threading.Thread(target=flood)
                flooding.start()
                view.end()
                flooding.join()


    def paused(self, viewer):
        state = viewer.state()
        while state["playing"] or not state["line"]:
            state = viewer.state()
        return state

    def test_parameters_are_set_and_repeated(self):
        with View("--rate", 0) as view, view.open() as viewer:
            asked = viewer.ask(do="parameters", type="runner")["parameters"]
            wander = next(each["controller"] for each in asked if "controller" in each)
            self.assertEqual(wander["cruise_speed_mps"], 0.4)
            for number in (0.9, 0.1):
                done = viewer.ask(do="set", type="runner", controller={"kind": "wander", "cruise_speed_mps": number})
                self.assertEqual(done["type"], "done")
                viewer.ask(do="step", ticks=10)
                self.paused(viewer)
            self.assertEqual(viewer.ask(do="set", type="runner", drive={"velocity_max_x_mps": 0.05})["type"], "done")
            viewer.ask(do="step", ticks=10)
            shown = self.paused(viewer)
            for setting, reason in (({"drive": {"wheels": 3}}, "wheels"), ({}, "give exactly one of"),
                                    ({"controller": {"kind": "wander", "cruise_speed_mps": "fast"}}, "cruise_speed_mps")):
                self.assertIn(reason, viewer.ask(do="set", type="runner", **setting)["reason"])
            self.assertIn("unknown type", viewer.ask(do="parameters", type="x")["reason"])
            view.end()
            for threads in (1, 3):
                self.assertEqual(view.replayed("--threads", threads)[shown["tick"]], shown["line"])

    def test_a_restart_begins_another_session(self):
        with View("--rate", 0) as view, view.open() as viewer:
            viewer.ask(do="move", robot="red", pose=[-3, -2, 0, 1])
            viewer.ask(do="step", ticks=20)
            first = self.paused(viewer)
            self.assertEqual(viewer.ask(do="restart")["type"], "done")
            again = self.paused(viewer)
            self.assertEqual((again["tick"], again["run"], again["session"]), (0, 2, "rooms.session-2.jsonl"))
            viewer.ask(do="disable", robot="blue")
            viewer.ask(do="step", ticks=20)
            second = self.paused(viewer)
            viewer.send('{"do": "restart", "seed": 9, "id": 2}')
            hellos = []
            while not (hellos and hellos[-1]["type"] == "done"):
                message = viewer.receive()
                if isinstance(message, bytes):
                    viewer.send('{"do": "drawn"}')
                elif message["type"] != "state":
                    hellos.append(message)
            self.assertEqual(hellos[0]["header"]["about"]["seed"], "9", "the places are sent again")
            viewer.ask(do="step", ticks=20)
            third = self.paused(viewer)
            self.assertNotEqual(third["line"], second["line"])
            view.end()
            for state, arguments in ((first, ()), (second, ()), (third, ("--seed", 9))):
                log = view.replayed(*arguments, session=view.folder / state["session"])
                self.assertEqual(log[state["tick"]], state["line"])

    def test_a_run_from_a_checkpoint_is_not_restarted(self):
        with View("--rate", 0, checkpoint_s=1) as view, view.open() as viewer:
            self.assertIn("began at a checkpoint", viewer.ask(do="restart")["reason"])

    def test_it_runs_until_a_time(self):
        with View("--rate", 0) as view, view.open() as viewer:
            viewer.ask(do="pause")
            tick = self.paused(viewer)["tick"]
            end = round((tick + 50) * viewer.hello["tick_s"], 6)
            self.assertEqual(viewer.ask(do="until", time_s=end)["type"], "done")
            self.assertEqual(self.paused(viewer)["tick"], tick + 50)
            self.assertIn("already at", viewer.ask(do="until", time_s=end)["reason"])
            self.assertIn("must be a number", viewer.ask(do="until", time_s=-1)["reason"])

    def test_it_runs_until_a_time_also_after_a_restart(self):
        with View("--rate", 20) as view, view.open() as viewer:
            viewer.ask(do="step", ticks=100)
            self.paused(viewer)
            viewer.ask(do="until", time_s=200)  # 9.5 s later
            self.assertEqual(viewer.ask(do="restart")["type"], "done")
            viewer.ask(do="rate", rate=0)
            state = self.paused(viewer)
            while state["run"] < 2:  # a picture from before the restart
                state = self.paused(viewer)
            self.assertEqual(state["tick"], 2000)

    def test_checkpoints_and_recordings_are_of_the_run(self):
        with View("--rate", 0) as view, view.open() as viewer:
            self.assertEqual(viewer.ask(do="record")["file"], "rooms.recording.h5")
            self.assertIn("recorded already", viewer.ask(do="record")["reason"])
            viewer.ask(do="move", robot="blue", pose=[3, -2, 0, 1])
            saved = viewer.ask(do="checkpoint")
            self.assertEqual(saved["file"], "rooms.checkpoint.h5")
            viewer.ask(do="disable", robot="red")
            self.assertEqual(viewer.ask(do="checkpoint")["file"], "rooms.checkpoint-2.h5", "no file is replaced")
            viewer.ask(do="step", ticks=30)
            shown = self.paused(viewer)
            self.assertEqual(viewer.ask(do="stop_recording")["type"], "done")
            view.end()
            for checkpoint in ("rooms.checkpoint.h5", "rooms.checkpoint-2.h5"):
                self.assertEqual(view.replayed(command=("resume", checkpoint))[shown["tick"]], shown["line"])
            said = subprocess.run([TROUPE, "info", view.folder / "rooms.recording.h5"], check=True, capture_output=True, text=True).stdout
            self.assertIn("frames", said)

    def test_a_paused_run_is_saved_and_restarted_at_its_tick(self):
        with View("--rate", 0) as view, view.open() as viewer:
            viewer.ask(do="step", ticks=10)
            shown = self.paused(viewer)
            self.assertEqual(viewer.ask(do="checkpoint")["file"], "rooms.checkpoint.h5")
            self.assertEqual(viewer.ask(do="record")["type"], "done")
            self.assertEqual(viewer.ask(do="stop_recording")["type"], "done")
            again = self.paused(viewer)
            self.assertEqual((again["tick"], again["line"]), (shown["tick"], shown["line"]), "no tick was computed")
            # An act belongs to the next tick, so that this tick is computed before files of the end of a tick are written.
            self.assertEqual(viewer.ask(do="disable", robot="blue")["type"], "done")
            self.assertEqual(self.paused(viewer)["tick"], shown["tick"])
            viewer.ask(do="checkpoint")
            later = self.paused(viewer)
            self.assertEqual(later["tick"], shown["tick"] + 1)
            self.assertEqual(viewer.ask(do="restart")["type"], "done")
            self.assertEqual(self.paused(viewer)["tick"], 0)
            self.assertEqual(json.loads(view.session.read_text().splitlines()[-1]), {"tick": later["tick"], "n": 2, "do": "end"})
            view.end()
            for checkpoint, first in (("rooms.checkpoint.h5", shown), ("rooms.checkpoint-2.h5", later)):
                log = view.replayed("--for", 1 + later["tick"] * viewer.hello["tick_s"], command=("resume", checkpoint))
                self.assertEqual(log[later["tick"]], later["line"])
                self.assertEqual(min(log), first["tick"], "the checkpoint is of the tick that the page showed")

    def test_a_refused_restart_computes_no_tick(self):
        with View("--rate", 0, checkpoint_s=1) as view, view.open() as viewer:
            viewer.ask(do="step")
            tick = self.paused(viewer)["tick"]
            self.assertEqual(viewer.ask(do="disable", robot="red")["type"], "done")
            self.assertEqual(viewer.ask(do="restart")["type"], "refused")
            viewer.ask(do="inspect", robot="red")  # the answer comes with a new picture
            self.assertEqual(self.paused(viewer)["tick"], tick)

    def test_a_kill_while_users_act_leaves_a_session_that_is_repeated(self):
        with View("--rate", 0, world=YARD) as view:
            lines, begun = [], threading.Event()

            def drive(number):
                draw = random.Random(number)
                try:
                    with view.open() as viewer:
                        while True:
                            viewer.ask(do="hold", robot=f"b{draw.randrange(30)}", speed=[draw.uniform(-1, 1), 0, draw.uniform(-2, 2)])
                            if number == 0:
                                viewer.ask(do="step", ticks=3)
                                lines.append(self.paused(viewer)["line"])
                                if len(lines) == 20:
                                    begun.set()
                except OSError:
                    pass  # the program was killed
            clients = [threading.Thread(target=drive, args=(number,)) for number in range(3)]
            for client in clients:
                client.start()
            self.assertTrue(begun.wait(120))
            view.process.kill()
            for client in clients:
                client.join()
            view.process.wait()
            written = view.session.read_text()
            self.assertNotIn('"end"', written)
            self.assertGreater(written.count("\n"), 20)
            last = max(int(line.split()[0]) for line in lines)
            for threads in (1, 2, 3):
                log = view.replayed("--threads", threads, "--for", last * 0.1)
                self.assertEqual([log[int(line.split()[0])] for line in lines], lines)

    def test_a_viewer_sees_values_and_lines(self):
        with View("--rate", 0, world=YARD) as view, view.open(None) as viewer:
            names = {(value["component"], value["field"]) for value in viewer.hello["values"]}
            self.assertIn(("velocity", "x"), names)
            self.assertEqual(viewer.hello["layers"], ["radio"])
            self.assertEqual((viewer.hello["populations"], viewer.hello["heights_m"]), (["b"], [0]))
            self.assertEqual(viewer.hello["namesakes"], [])
            self.assertEqual(viewer.ask(do="color", component="pose", field="x", column=0)["type"], "done")
            self.assertEqual(viewer.ask(do="layers", layers=["radio"])["type"], "done")
            self.assertIn("no field", viewer.ask(do="color", component="pose", field="w")["reason"])
            for name in ("lamp", "led/lamp"):
                self.assertEqual(viewer.ask(do="color", component=name, field="shown_color")["type"], "done")
            self.assertEqual(viewer.ask(do="color", component="pose", field="x", column=0)["type"], "done")
            self.assertIn('unknown layer "x"', viewer.ask(do="layers", layers=["x"])["reason"])
            state = viewer.state()
            while "shades" not in state or not state.get("lines", {}).get("radio"):
                state = viewer.state()
            self.assertGreaterEqual(state["shades"]["least"], -8)
            self.assertLessEqual(state["shades"]["most"], 8)
            self.assertGreater(state["shades"]["most"], state["shades"]["least"] + 4)
            lines = state["lines"]["radio"]
            self.assertEqual(len(lines) % 6, 0)
            for i in range(0, len(lines), 6):
                (x0, y0, _), (x1, y1, _) = lines[i:i + 3], lines[i + 3:i + 6]
                self.assertLess((x1 - x0) ** 2 + (y1 - y0) ** 2, 3.3 ** 2, "they hear as far as the radio reaches")

    def test_a_viewer_sees_and_sets_commands_of_devices(self):
        with View("--rate", 0, world=YARD) as view, view.open() as viewer:
            viewer.ask(do="inspect", robot="b3")
            self.assertEqual(viewer.ask(do="command", robot="b3", device="lamp", values={"red": [0.25], "shows": [1]})["type"], "done")
            state = viewer.state()
            while state.get("inspected", {}).get("commands", {}).get("lamp", {}).get("red") != [0.25]:
                state = viewer.state()
            self.assertEqual(state["inspected"]["commands"]["lamp"]["shows"], [1])

    def test_a_viewer_sees_that_a_sensor_does_not_run(self):
        world = json.loads(json.dumps(YARD))
        world["types"]["bot"]["sensors"].append(
            {"name": "sonar", "kind": "ranger", "active": False, "transducers": [{"range_max_m": 2}]})
        with View("--rate", 0, world=world) as view, view.open() as viewer:
            viewer.ask(do="inspect", robot="b3")
            state = viewer.state()
            while "inspected" not in state:
                state = viewer.state()
            parts = {part["name"]: part for part in state["inspected"]["components"]}
            self.assertEqual(parts["lamp"]["component"], "led/lamp")
            self.assertTrue(parts["eye"]["runs"])
            self.assertFalse(parts["sonar"]["runs"])
            self.assertEqual(parts["sonar"]["fields"][0]["values"], [None])

    def test_a_thousand_acts_of_three_viewers_are_repeated(self):
        with View("--rate", 20, world=YARD) as view:
            done, refused, files = {}, [0], []

            def act(number):
                draw = random.Random(number)
                viewer = view.open()
                i, accepted = -1, 0
                while accepted < 340:
                    i += 1
                    if i in (100, 200):  # the viewer is disconnected while it holds a robot
                        viewer.ask(do="hold", robot=f"b{number}", speed=[0.3, 0, 1])
                        viewer.socket.close()
                        viewer = view.open()
                    if i == 170 and number == 0:
                        files.append(viewer.ask(do="checkpoint")["file"])
                    what = draw.choice(["move", "speed", "hold", "release", "command", "add", "remove", "disable", "enable", "set"])
                    if what == "remove" and draw.random() < 0.7:
                        what = "move"
                    message = {"do": what, "robot": f"b{draw.randrange(60)}"}
                    pose = [draw.uniform(-8, 8), draw.uniform(-8, 8), 0, draw.uniform(-4, 4)]
                    if what == "move":
                        message["pose"] = pose
                    elif what in ("speed", "hold"):
                        message["speed"] = [draw.uniform(-1, 1), 0, draw.uniform(-2, 2)]
                    elif what == "command":
                        message |= {"device": "lamp", "values": {"shows": draw.randrange(2), "red": draw.random()}}
                    elif what == "add":
                        message = {"do": what, "population": "b", "pose": pose}
                    elif what == "set":
                        message = {"do": what, "type": "bot", "controller": {"kind": "wander", "cruise_speed_mps": draw.uniform(0, 1)}}
                    if viewer.ask(**message)["type"] == "done":
                        done[what] = done.get(what, 0) + 1
                        accepted += 1
                    else:
                        refused[0] += 1
                viewer.socket.close()
            clients = [threading.Thread(target=act, args=(number,)) for number in range(3)]
            for client in clients:
                client.start()
            for client in clients:
                client.join()
            with view.open() as viewer:
                viewer.ask(do="pause")
                state = self.paused(viewer)
            view.process.kill()
            view.process.wait()
            self.assertEqual(len(done), 10, (done, refused))
            self.assertGreater(sum(done.values()), 1000, (done, refused))
            end = ("--for", state["tick"] * viewer.hello["tick_s"])
            for arguments, command in (((1,), ("run", "rooms.json")), ((2,), ("run", "rooms.json")), ((3,), ("run", "rooms.json")),
                                       ((1, "--ranks", 3), ("run", "rooms.json")), ((3,), ("resume", files[0]))):
                log = view.replayed("--threads", *arguments, *end, command=command)
                self.assertEqual(log[state["tick"]], state["line"], (arguments, command))


class OfARun(unittest.TestCase):
    def test_it_is_shown_and_its_session_repeated(self):
        with tempfile.TemporaryDirectory() as folder:
            world = Path(folder) / "rooms.json"
            world.write_text(json.dumps(WORLD))
            command = [TROUPE, "run", world, "--for", "60", "--rate", "20", "--view", "--quiet", "--hash-log", "a.log"]
            with subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True) as run:
                said = dict(run.stderr.readline().split() for _ in range(3))
                port, token = said["view"].removeprefix("http://127.0.0.1:").split("/#")
                with Socket(int(port)) as viewer:
                    viewer.send(token)
                    self.assertTrue(viewer.receive()["may_steer"])
                    self.assertEqual(viewer.ask(do="move", robot="blue", pose=[3, -2, 0, 1])["type"], "done")
                    self.assertEqual(viewer.ask(do="disable", robot="red")["type"], "done")
                    self.assertIn("the page cannot restart this run", viewer.ask(do="restart")["reason"])
                    self.assertEqual(viewer.ask(do="rate", rate=0)["type"], "done")
                self.assertEqual(run.wait(60), 0)
            subprocess.run([TROUPE, "run", world, "--session", Path(folder) / said["session"], "--quiet", "--hash-log", "b.log"],
                           cwd=folder, check=True)
            logs = [[line for line in (Path(folder) / name).read_text().splitlines() if not line.startswith("#")] for name in ("a.log", "b.log")]
            self.assertEqual(len(logs[0]), 601)
            self.assertEqual(*logs)
            refused = subprocess.run([TROUPE, "run", world, world, "--for", "1", "--view"], capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2)
            self.assertIn("--view: error: --view shows the run of one world, but 2 worlds are given", refused.stderr)


class NotTouched(unittest.TestCase):
    """A run in which no user acts has the hash log of a run that no page shows, although users look at everything."""

    def test_a_viewed_run_has_the_hash_log_of_one_that_is_not_viewed(self):
        colony = json.loads((ROOT / "worlds" / "colony.json").read_text())  # births and deaths
        for world in (WORLD, YARD, colony):
            with self.subTest(world["title"]), View("--rate", 0, world=world) as view, view.open() as viewer:
                viewer.ask(do="inspect", robot=viewer.hello["header"]["robots"]["name"][0])
                viewer.ask(do="plot", measure="displacement")
                viewer.ask(do="color", component="pose", field="x", column=0)
                viewer.ask(do="layers", layers=viewer.hello["layers"])
                shown = []
                for _ in range(5):
                    viewer.ask(do="step", ticks=40)
                    state = viewer.state()
                    while state["playing"] or not state["line"]:
                        state = viewer.state()
                    self.assertIn("inspected", state)
                    shown.append(state)
                shown.append({"line": view.end()})
                log = view.folder / "alone.log"
                end = (int(shown[-1]["line"].split()[0]) + 0.5) * viewer.hello["tick_s"]
                subprocess.run([TROUPE, "run", view.world, "--for", str(end), "--quiet", "--hash-log", log], check=True)
                alone = log.read_text().splitlines()
                for state in shown:
                    self.assertIn(state["line"], alone)


class OfTheDocumentation(unittest.TestCase):
    @unittest.skipIf(importlib.util.find_spec("websockets") is None, "the package websockets is not installed")
    def test_the_client_in_python_sees_the_robots_move(self):
        page = (ROOT / "docs" / "live.md").read_text()
        listing = page[page.index("import asyncio"):].split("```")[0]
        with View("--rate", 1) as view:
            (view.folder / "watch.py").write_text(listing.replace("pictures=100", "pictures=20"))
            printed = subprocess.run([sys.executable, view.folder / "watch.py", view.address], check=True, capture_output=True,
                                     text=True, timeout=WAIT_S).stdout.split("\n")[:-1]
            seen = [(int(tick), name, float(x)) for tick, name, x, _ in map(str.split, printed)]
            self.assertEqual(len(seen), 20)
            self.assertEqual({name for _, name, _ in seen}, {"red"})
            self.assertEqual(seen, sorted(seen), "it drives east")
            with view.open() as viewer:  # the speed of the controller, from the state
                viewer.ask(do="inspect", robot="red")
                state = viewer.state()
                while "inspected" not in state:
                    state = viewer.state()
                speed = next(c for c in state["inspected"]["components"] if c["name"] == "velocity")["fields"][0]["values"][0]
            ticks = seen[-1][0] - seen[0][0]
            self.assertGreater(ticks, 5)
            self.assertGreater(speed, 0)
            self.assertLess(seen[-1][2] - seen[0][2], 0.11 * ticks)
            self.assertGreater(seen[-1][2] - seen[0][2], 0.01 * ticks)


def can_run(file, other):
    """Whether another user can run this program. other: the keywords of subprocess.run() for this user."""
    try:
        return subprocess.run([file, "-c", ""], **other).returncode == 0
    except OSError:
        return False


class ASlowLink(unittest.TestCase):
    def test_page_and_long_message_arrive(self):
        def slow(text):
            """Opens a connection over which the server can send only about 100 kB before the client reads."""
            connection = socket.socket()
            self.addCleanup(connection.close)
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_MAXSEG, 536)
            connection.settimeout(WAIT_S)
            connection.connect(("127.0.0.1", view.port))
            connection.sendall(text.encode())
            return connection
        world = json.loads(json.dumps(YARD))
        world["bounds_m"] = [[-200, -200], [200, 200]]
        world["populations"][0] |= {"count": 30000, "reserve": 0, "place": {"rule": "grid", "region_m": [[-190, -190], [190, 190]], "pitch_m": 2}}
        with View("--rate", 1, world=world) as view:
            page = slow("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
            viewer = slow("GET /live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                          "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n")
            head = b""
            while not head.endswith(b"\r\n\r\n"):
                head += viewer.recv(1)
            token = view.token.encode()
            viewer.sendall(bytes([0x81, 0x80 | len(token), 0, 0, 0, 0]) + token)
            time.sleep(8)  # a connection without a token ends after 5 s
            answer = b""
            while data := page.recv(1 << 16):
                answer += data
            head, _, body = answer.partition(b"\r\n\r\n")
            length = next(int(line.split(b":")[1]) for line in head.split(b"\r\n") if line.lower().startswith(b"content-length"))
            self.assertEqual(len(body), length)
            time.sleep(30)  # a client that is silent for 30 s is disconnected, unless a long message is being sent to it
            frame = b""
            while len(frame) < 10:
                frame += viewer.recv(10 - len(frame))
            self.assertEqual(frame[:2], b"\x81\x7f", "a long text")
            (size,) = struct.unpack(">Q", frame[2:10])
            self.assertGreater(size, 250_000)
            while len(frame) < 10 + size:
                data = viewer.recv(1 << 16)
                self.assertTrue(data, "the server has closed the connection")
                frame += data
            self.assertEqual(json.loads(frame[10:10 + size])["type"], "hello")


class Attacked(unittest.TestCase):
    """Invalid requests: each is refused and reported once, and the run goes on."""

    def setUp(self):
        self.view = View("--rate", 0)
        self.addCleanup(self.view.__exit__)
        self.viewer = self.view.open()
        self.addCleanup(self.viewer.__exit__)

    def tearDown(self):
        tick = self.viewer.state()["tick"]
        while self.viewer.state()["tick"] == tick:
            pass
        self.assertIsNone(self.view.process.poll())

    def assert_said_once(self, text):
        self.assertEqual(self.view.said().count(text), 1, self.view.said())

    def get(self, path="/", host=None, method="GET"):
        answer = request(self.view.port, f"{method} {path} HTTP/1.1\r\nHost: {host or '127.0.0.1'}\r\n\r\n")
        return int(answer.split()[1]), answer

    def test_wrong_host(self):
        for host in ("evil.example", "evil.example:80", "127.0.0.1.evil.example", "localhost:x", "[::1]x", "127.0.0.1:"):
            self.assertEqual(self.get(host=host)[0], 403, host)
            with self.assertRaises(Refused) as caught:
                Socket(self.view.port, host=host)
            self.assertEqual(caught.exception.args[0], 403)
        for host in ("127.0.0.1", "localhost:8000", "[::1]:8000"):
            self.assertEqual(self.get(host=host)[0], 200, host)
        self.assert_said_once("whose Host header names neither this machine nor a host given with --allow-host")

    def test_other_addresses(self):
        with View("--bind", "127.0.0.2", "--allow-host", "Proxy.Example:8443") as view:
            self.assertTrue(view.address.startswith(f"http://127.0.0.2:{view.port}/#"))

            def get(host, address="127.0.0.2"):
                with socket.create_connection((address, view.port), timeout=WAIT_S) as connection:
                    connection.sendall(f"GET / HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
                    return connection.recv(4096)
            for host in (f"127.0.0.2:{view.port}", "proxy.example", "proxy.example:443", "PROXY.example"):
                self.assertIn(b" 200 ", get(host))
            self.assertIn(b"connect-src ws://proxy.example wss://proxy.example;", get("proxy.example"))
            for host in ("127.0.0.3", "example", "proxy.example.evil"):
                self.assertIn(b" 403 ", get(host))
            with self.assertRaises(ConnectionError):
                get("127.0.0.1", "127.0.0.1")
        refused = subprocess.run([TROUPE, "view", "x.json", "--bind", "localhost"], capture_output=True, text=True)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--bind: localhost", refused.stderr.replace('"', ""))
        for host in ("", ":80", "a b", "https://proxy.example"):
            refused = subprocess.run([TROUPE, "view", "x.json", "--allow-host", host], capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2, host)
            self.assertIn("a host name, as in --allow-host example.org", refused.stderr)
        if HAS_IPV6:
            with socket.create_connection(("::1", self.view.port), timeout=WAIT_S) as connection:
                connection.sendall(f"GET / HTTP/1.1\r\nHost: [::1]:{self.view.port}\r\n\r\n".encode())
                answer = connection.recv(4096)
                self.assertIn(b" 200 ", answer)
                self.assertIn(b"connect-src 'self';", answer)

    def test_foreign_origin(self):
        own = f"127.0.0.1:{self.view.port}"
        for origin in ("http://evil.example", "null", f"https://{own}", f"http://{own}.evil.example", "http://127.0.0.1:1"):
            with self.assertRaises(Refused) as caught:
                Socket(self.view.port, origin=origin)
            self.assertEqual(caught.exception.args[0], 403, origin)
        Socket(self.view.port, origin=f"http://{own}").__exit__()
        self.assert_said_once("another origin")

    def test_no_token_or_a_wrong_one(self):
        for token in ("", "x", self.view.token[:-1], self.view.token + "0", self.view.token[:-1] + "g", "{}"):
            with Socket(self.view.port) as stranger:
                stranger.send(token)
                with self.assertRaises(ConnectionError):
                    stranger.receive()
        with Socket(self.view.port) as silent:
            with self.assertRaises(ConnectionError):  # and not TimeoutError
                silent.receive()
        self.assert_said_once("without a valid token")

    def test_a_token_for_looking_commands_nothing(self):
        with self.view.open(self.view.look_token) as looker:
            self.assertFalse(looker.hello["may_steer"])
            for message in ({"do": "pause"}, {"do": "move", "robot": "red", "pose": [0, -3, 0, 0]}, {"do": "remove", "robot": "red"}):
                self.assertEqual(looker.ask(**message), {"type": "refused", "id": 1, "reason": "this address is read-only"})
            self.assertEqual(looker.ask(do="inspect", robot="red")["type"], "done")
            self.assertTrue(looker.state()["playing"])
        self.assert_said_once("a read-only viewer")
        self.assertEqual(self.view.session.read_text().count("\n"), 1, "nothing was done")

    def test_large_and_binary_messages(self):
        for data in ("x" * 10_000_000, b"abc"):
            for token in (None, self.view.token):
                with Socket(self.view.port) as stranger:
                    if token:
                        stranger.send(token)
                        stranger.receive()
                    with self.assertRaises(ConnectionError):
                        stranger.send(data)
                        while True:
                            stranger.receive()
        self.assert_said_once("a message longer than 64 kB")
        self.assert_said_once("a binary message")

    def test_messages_that_make_no_sense(self):
        refused = 0
        for text in ("", "{", "[]", "7", '{"do": 5}', '{"do": []}', '{"id": -1}', "\x00", "[" * 60000,
                     '{"do": "inspect", "robot": ' + "[" * 30000 + "]" * 30000 + "}",
                     '{"do":"play","do":"pause"}',
                     '{"do": "step", "ticks": -1}', '{"do": "step", "ticks": 1e300}', '{"do": "rate", "rate": "x"}',
                     '{"do": "inspect", "robot": 5}', '{"do": "inspect", "robot": "missing"}', '{"do": "plot", "measure": "x"}',
                     '{"do": "move", "robot": "red"}', '{"do": "move", "robot": "red", "pose": [1e999, 0, 0, 0]}', '{"do": "end"}',
                     '{"do": "command", "robot": "red", "device": "eye", "values": {"x": 1}}', '{"do": "fly", "id": 18446744073709551616}'):
            with self.view.open() as client:
                client.send(text)
                try:
                    answer = client.receive()
                    while not isinstance(answer, dict) or answer["type"] == "state":
                        answer = client.receive()
                    if "play" not in text:
                        self.assertEqual(answer["type"], "refused", text)
                        refused += 1
                except ConnectionError:
                    pass  # invalid UTF-8, or disconnected
        self.assertGreater(refused, 10)

    def test_ids_and_counts_are_whole_numbers(self):
        with self.view.open() as client:
            def answer_to(text):
                client.send(text)
                answer = client.receive()
                while not isinstance(answer, dict) or answer["type"] == "state":
                    answer = client.receive()
                return answer
            for number in ('"7"', "-1", "null", "1.5"):
                answer = answer_to('{"do": "pause", "id": %s}' % number)
                self.assertEqual(answer, {"type": "refused", "reason": '"id" must be a whole number from 0 to 2^64 - 1'})
            with self.view.open(self.view.look_token) as looker:
                looker.send('{"do": "pause"}')
                answer = looker.receive()
                while not isinstance(answer, dict) or answer["type"] == "state":
                    answer = looker.receive()
                self.assertEqual(answer, {"type": "refused", "id": 0, "reason": "this address is read-only"})
            self.assertEqual(answer_to('{"do": "pause"}'), {"type": "done", "id": 0})
            self.assertEqual(answer_to('{"do": "step", "ticks": 1.5, "id": 7}'),
                             {"type": "refused", "id": 7, "reason": '"ticks" must be a whole number from 1 to 1000000000, found 1.5'})

    def test_a_viewer_too_many_is_told_why(self):
        viewers = [self.view.open() for _ in range(15)]  # setUp has opened one
        for viewer in viewers:
            self.addCleanup(viewer.__exit__)
        with Socket(self.view.port) as other:
            other.send(self.view.look_token)
            first, size = other.bytes(2)
            self.assertEqual(first, 0x88, "a close frame")
            payload = other.bytes(size)
            self.assertEqual(struct.unpack(">H", payload[:2]), (1013,))
            self.assertEqual(payload[2:].decode(), "16 viewers are connected, the most that are allowed: close another page "
                                                   "of this view, then load this page again")
            other.send(payload, 8)
            with self.assertRaises(ConnectionError):
                other.receive()
        self.assert_said_once("a viewer, because at most 16 viewers can be connected")
        viewers.pop().__exit__()
        until = time.monotonic() + WAIT_S
        while time.monotonic() < until:
            try:
                self.view.open().__exit__()
                break
            except ConnectionError:
                time.sleep(0.02)  # the server has not yet noticed the end of the connection

    def test_half_open_connections(self):
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, min(hard, 4096)), hard))
        strangers = [socket.create_connection(("127.0.0.1", self.view.port)) for _ in range(1000)]
        for stranger in strangers[::2]:
            try:
                stranger.sendall(b"GET / HTTP/1.1\r\nHost: loc")
            except OSError:
                pass  # disconnected to make room for other connections
        self.assertEqual(self.get()[0], 200)
        with self.view.open() as other:
            self.assertEqual(other.hello["type"], "hello")
        descriptors = lambda: len(os.listdir(f"/proc/{self.view.process.pid}/fd"))
        until = time.monotonic() + WAIT_S
        while descriptors() >= 40 and time.monotonic() < until:
            time.sleep(0.1)
        self.assertLess(descriptors(), 40, "those that say nothing are cut off")
        for stranger in strangers:
            stranger.close()
        self.assert_said_once("connections without a token")

    def test_garbage_frames(self):
        draw = random.Random(1)
        for i in range(300):
            with Socket(self.view.port, timeout=20) as stranger:
                if i % 2:
                    stranger.send(self.view.token)
                    stranger.receive()
                begin = bytes([draw.choice([0x00, 0x01, 0x02, 0x03, 0x80, 0x81, 0x82, 0x83, 0x88, 0x89, 0x8a, 0x8f, 0xc1, 0xf1, 0xff]),
                               draw.choice([0, 5, 0x80, 0x85, 125, 126, 127, 0xfd, 0xfe, 0xff])])
                try:
                    stranger.socket.sendall(begin + draw.randbytes(draw.randrange(400)))
                    stranger.socket.shutdown(socket.SHUT_WR)
                    while True:
                        stranger.receive()
                except (OSError, ValueError, AssertionError):
                    pass  # disconnected, or closed as the protocol requires
        self.assertEqual(self.get()[0], 200)

    @unittest.skipUnless(os.geteuid() == 0, "only root can be another user")
    def test_another_user_of_the_machine(self):
        with tempfile.TemporaryDirectory() as folder:
            os.chmod(folder, 0o755)
            opener = Path(folder) / "xdg-open"
            opener.write_text(f"#!/bin/sh\necho \"$1\" > {folder}/opened.part\nmv {folder}/opened.part {folder}/opened\n")
            opener.chmod(0o755)
            with View("--open", environment={"PATH": f"{folder}:{os.environ['PATH']}"}) as view:
                opened = Path(folder) / "opened"
                until = time.monotonic() + WAIT_S
                while not opened.exists() and time.monotonic() < until:
                    time.sleep(0.02)
                page = Path(opened.read_text().strip())
                self.assertIn(view.token, page.read_text())
                attack = f"""
import socket, sys
def get(text):
    with socket.create_connection(("127.0.0.1", {view.port}), timeout={WAIT_S}) as connection:
        connection.sendall(text.encode())
        data = b""
        while True:
            try:
                more = connection.recv(65536)
            except OSError:
                return data
            if not more:
                return data
            data += more
print(get("GET / HTTP/1.1\\r\\nHost: 127.0.0.1\\r\\n\\r\\n").decode())
for file in ("/proc/{view.process.pid}/cmdline", "/proc/{view.process.pid}/environ", "/proc/{view.process.pid}/mem", {str(page)!r},
             {str(view.session)!r}):
    try:
        print(open(file, "rb").read().decode(errors="replace"))
    except OSError as error:
        print(file, "unreadable")
"""
                other = {"user": 65534, "group": 65534, "extra_groups": [], "cwd": "/"}
                python = next((file for file in (shutil.which("python3"), "/usr/bin/python3") if can_run(file, other)), None)
                if python is None:
                    self.skipTest("NOT TESTED: there is no Python that another user can run")
                seen = subprocess.run([python, "-c", attack], capture_output=True, text=True, check=True, **other).stdout
                self.assertIn("200 OK", seen)
                self.assertIn(f"{page} unreadable", seen)
                self.assertNotIn(view.token, seen)
                self.assertNotIn(view.look_token, seen)
                with Socket(view.port) as stranger:
                    stranger.send("0" * 32)
                    with self.assertRaises(ConnectionError):
                        stranger.receive()

    def test_other_requests(self):
        self.assertEqual(self.get("/../../etc/passwd")[0], 404)
        self.assertEqual(self.get("/rooms.json")[0], 404)
        self.assertEqual(self.get(method="POST")[0], 405)
        request(self.view.port, b"\x16\x03\x01\x02\x00" + os.urandom(200))
        request(self.view.port, "GET / HTTP/1.1\r\n" + "x: y\r\n" * 5000 + "\r\n")
        status, answer = self.get()
        self.assertEqual(status, 200)
        self.assertIn(b"connect-src ws://127.0.0.1;", answer)
        self.assertNotIn(self.view.token.encode(), answer)


@unittest.skipIf(PROGRAM is None, "no Chromium (scripts/setup --checks installs it)")
class InABrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.view = View("--rate", 1)
        cls.addClassCleanup(cls.view.__exit__)
        cls.page = Page(PROGRAM, SIZE)
        cls.addClassCleanup(cls.page.__exit__)

    def keep(self, name):
        if PICTURES:
            (PICTURES / f"{name}.png").write_bytes(self.page.screenshot())

    def state(self):
        return self.page.run("(({scriptMs, ...rest}) => rest)(troupe.state())")

    def place(self, name):
        return self.page.run(f"troupe.screenPlace('{name}', [0, 0, 0])")

    def press_button(self, selector):
        self.press_button_of(self.page, selector)

    def press_button_of(self, page, selector):
        box = page.run(f"(({{x, y, width, height}}) => [x + width / 2, y + height / 2])"
                            f"(document.querySelector('{selector}').getBoundingClientRect())")
        page.click(*box)

    def paused(self):
        self.page.wait("!troupe.state().playing && troupe.state().line")
        return self.state()

    def drag_to(self, name, x, y):
        """Drags the selected robot to a point of the floor; returns the message of the page."""
        start = self.place(name)
        here = self.page.run(f"troupe.pose('{name}')")
        end = self.page.run(f"troupe.screenPlace('{name}', [{x - here[0]}, {y - here[1]}, 0])")
        self.page.run("document.getElementById('told').hidden = true")
        self.page.drag(start, end)

    def test_a_person_uses_it(self):
        view, page = self.view, self.page
        page.open_address(view.address)
        page.wait("window.troupe && troupe.state().tick > 5")
        self.assertEqual(page.run("location.hash"), "", "the token is out of sight")
        x = page.run("troupe.pose('red')")
        page.wait(f"troupe.pose('red')[0] !== {x[0]}")
        self.keep("running")

        self.press_button("#play")
        before = self.paused()
        page.wait("document.getElementById('line').textContent === troupe.state().line")
        self.press_button("#step")
        page.wait(f"troupe.state().tick > {before['tick']} && !troupe.state().playing")
        after = self.paused()
        self.assertEqual(after["tick"], before["tick"] + 1)

        page.run("troupe.select('red')")
        page.wait("troupe.inspected() && troupe.state().scanned")
        self.assertIn("condition", page.run("document.getElementById('panel').innerText"))
        self.keep("inspected")

        self.drag_to("red", 3, -2)  # into the other room
        page.wait("Math.abs(troupe.pose('red')[0] - 3) < 0.05 && Math.abs(troupe.pose('red')[1] + 2) < 0.05")
        self.drag_to("red", 0, 2)  # into the wall
        page.wait("!document.getElementById('told').hidden")
        self.assertIn("a wall or another body is there", page.run("document.getElementById('told').textContent"))
        self.keep("refused")
        page.wait("Math.abs(troupe.pose('red')[0] - 3) < 0.05")
        heading = page.run("troupe.pose('red')[3]")
        page.press("q", "KeyQ")
        page.wait(f"Math.abs(troupe.pose('red')[3] - {heading}) > 0.2")

        page.run("document.querySelector('#values details').open = true")
        page.wait("document.querySelector('[data-parameter=cruise_speed_mps]') !== null")
        page.run("(input => { input.value = '0.9'; input.onchange(); })(document.querySelector('[data-parameter=cruise_speed_mps]'))")
        page.run("troupe.step(25)")  # it may be turning away from the wall for 20 ticks
        page.wait("troupe.inspected().components.find(c => c.name === 'velocity').fields[0].values[0] === 0.9")
        self.paused()
        self.keep("parameters")
        page.run("document.querySelector('#values details').open = false")

        page.run("troupe.follow(true)")
        page.run("(rate => { rate.selectedIndex = 5; rate.onchange({target: rate}); })(document.getElementById('rate'))")
        page.wait("troupe.state().rate === 5")
        page.run("(measure => { measure.value = 'displacement'; measure.onchange({target: measure}); })"
                 "(document.getElementById('measure'))")
        self.press_button("#play")
        page.wait("document.querySelector('#plot path').getAttribute('d').split('L').length > 10")
        for name in ("x", "heading"):
            page.run(f"[...document.querySelectorAll('#values > .plottable')].find(row => row.firstChild.innerText === '{name}').click()")
        page.wait("document.querySelectorAll('#plots path').length === 2 && "
                  "[...document.querySelectorAll('#plots path')].every(path => path.getAttribute('d').split('L').length > 10)")
        plotted = page.run("[...document.querySelectorAll('#plots .now')].map(line => line.textContent)")
        self.assertRegex(plotted[0], r"^pose x m -?[0-9.]+$")
        self.assertRegex(plotted[1], r"^pose heading ° -?[0-9.]+$")
        self.keep("plotted")

        page.press("m", "KeyM")
        page.call("Input.dispatchKeyEvent", type="keyDown", key="ArrowLeft", code="ArrowLeft")
        page.wait("troupe.inspected()?.components.find(c => c.name === 'velocity').fields.at(-1).values[0] === 1.2")
        page.call("Input.dispatchKeyEvent", type="keyUp", key="ArrowLeft", code="ArrowLeft")
        self.keep("driven")
        page.press("m", "KeyM")
        self.press_button("#disable")
        page.wait("document.getElementById('disable').textContent === 'enable'")
        page.run("troupe.theme('dark')")
        self.keep("dark")
        page.run("troupe.theme('light')")

        page.run("troupe.select(null)")
        for _ in range(2):  # the camera has followed red; V shows the whole world again
            page.press("v", "KeyV")
        red = self.place("red")
        page.drag([at - 10 for at in red], [at + 10 for at in red], shift=True)
        page.wait("troupe.group().length > 0")
        self.assertEqual(page.run("troupe.group()"), ["red"])
        page.drag((20, 20), (SIZE[0] - 20, SIZE[1] - 120), shift=True)  # everything between the title and the bars
        page.wait("troupe.group().length === 2")
        self.keep("group")
        self.press_button("#group-enable")
        page.wait("document.getElementById('told').textContent.startsWith('Refused for 1 of 2 robots')")
        self.press_button("#ungroup")
        page.wait("troupe.group().length === 0")

        page.run("troupe.color('pose.x')")
        page.wait("troupe.legend()[1] > troupe.legend()[0]")  # the two robots are in different places
        self.keep("coloured")
        page.run("troupe.color('own colours')")

        picture = base64.b64decode(page.run("troupe.picture()"))
        self.assertEqual(struct.unpack(">II", picture[16:24]), SIZE)

        self.press_button("#play")
        shown = self.paused()
        newest = page.run("troupe.pose('blue')")
        page.run("(back => { back.value = Number(back.max) - 3; back.oninput({target: back}); })(document.getElementById('back'))")
        page.wait("document.getElementById('now').textContent.endsWith(' s ago')")
        self.keep("past")
        self.press_button("#now")
        page.wait("document.getElementById('now').textContent === 'now'")
        self.assertEqual(page.run("troupe.pose('blue')"), newest)

        self.press_button("#checkpoint")
        page.wait("document.getElementById('told').textContent === 'rooms.checkpoint.h5 is written'")
        shown = self.paused()
        page.drag((20, 20), (SIZE[0] - 20, SIZE[1] - 120), shift=True)
        page.wait("troupe.group().length === 2")
        self.press_button("#group-remove")
        page.wait("troupe.group().length === 0 && troupe.state().robots === 0")
        self.press_button("#restart")
        page.wait("troupe.state().run === 2")
        restarted = self.paused()
        self.assertEqual(restarted["tick"], 0)
        page.wait("troupe.pose('red')[3] === 0 && Math.abs(troupe.pose('red')[0] + 3) < 1e-3")  # it is drawn again
        self.keep("restarted")
        self.assertEqual(page.problems, [])
        view.end()
        page.wait("document.getElementById('problem').innerText.startsWith('The program has ended')")
        log = view.replayed()
        for state in (before, after, shown):
            self.assertEqual(log[state["tick"]], state["line"])

    def test_robots_are_found_and_followed(self):
        with View() as view, Page(PROGRAM, SIZE) as page:
            page.open_address(view.address)
            page.wait("window.troupe && troupe.state().tick > 2")
            self.press_button_of(page, "#play")
            page.wait("!troupe.state().playing && troupe.state().line")
            tick = page.run("troupe.state().tick")
            page.run("document.getElementById('ticks').value = '7'")
            self.press_button_of(page, "#step")
            page.wait(f"troupe.state().tick === {tick + 7} && !troupe.state().playing")

            page.press("/", "Slash")
            page.call("Input.insertText", text="blue")
            page.call("Input.dispatchKeyEvent", type="keyDown", key="Enter", code="Enter", windowsVirtualKeyCode=13, text="\r")
            page.wait("troupe.inspected()?.robot === 'blue'")
            self.assertEqual(page.run("document.getElementById('find').value"), "")
            page.run("(input => { input.value = 'green'; input.onchange({target: input}); })(document.getElementById('find'))")
            self.assertEqual(page.run("document.getElementById('told').textContent"), 'There is no robot "green".')
            self.assertEqual(page.run("troupe.state().selected"), "blue")

            page.press("f", "KeyF")
            page.wait("troupe.following()[0]")
            page.run("document.getElementById('follow-all').click()")
            page.wait("troupe.following()[1] && !troupe.following()[0]")
            spread = "Math.hypot(...['red', 'blue'].map(name => troupe.screenPlace(name)).reduce(([a, b], [c, d]) => [a - c, b - d]))"
            # blue moves to red: the picture of both is enlarged. Then red moves to the other end: it stays in the picture.
            for robot, (x, y) in (("blue", (-3, -2.2)), ("red", (5, 3)), ("blue", (-5.5, -3.5))):
                page.run(f"troupe.act({{do: 'move', robot: '{robot}', pose: [{x}, {y}, 0, 0]}})")
                page.wait(f"Math.abs(troupe.pose('{robot}')[0] - {x}) < 1e-2")
                page.wait(f"{spread} > 200")
                for name in ("red", "blue"):
                    x, y = page.run(f"troupe.screenPlace('{name}')")
                    self.assertTrue(0 < x < SIZE[0] and 0 < y < SIZE[1], (robot, name, x, y))
            page.press("a", "KeyA")
            page.wait("!troupe.following()[1]")
            # Without following, the picture stays; a robot that is found outside of it is moved into its middle.
            before = page.run("troupe.screenPlace('blue')")
            page.run("troupe.act({do: 'move', robot: 'red', pose: [-4, -3, 0, 0]})")
            page.wait("Math.abs(troupe.pose('red')[0] + 4) < 1e-2")
            for now, then in zip(page.run("troupe.screenPlace('blue')"), before):
                self.assertAlmostEqual(now, then, places=2)
            page.run("troupe.act({do: 'move', robot: 'red', pose: [4, 3, 0, 0]})")
            page.wait("Math.abs(troupe.pose('red')[0] - 4) < 1e-2")
            for _ in range(5):  # zoom in at blue
                page.mouse("mouseWheel", *before, deltaX=0, deltaY=-400)
            page.wait(f"troupe.screenPlace('red')[0] > {SIZE[0]}")
            page.run("(input => { input.value = 'red'; input.onchange({target: input}); })(document.getElementById('find'))")
            page.wait(f"Math.abs(troupe.screenPlace('red')[0] - {SIZE[0] / 2}) < 30")
            self.assertEqual(page.problems, [])

    @contextlib.contextmanager
    def opened(self, *arguments, world=WORLD, script=None):
        """A view and its page, which runs `script` before its own script."""
        with View(*arguments, world=world) as view, Page(PROGRAM, SIZE) as page:
            if script:
                page.call("Page.addScriptToEvaluateOnNewDocument", source=f"{{{script}}}")
            page.open_address(view.address)
            page.wait("window.troupe && troupe.state().tick > 2")
            yield view, page

    def pause(self, page):
        self.press_button_of(page, "#play")
        page.wait("!troupe.state().playing && troupe.state().line")

    def key(self, page, kind, key):
        page.call("Input.dispatchKeyEvent", type=kind, key=key, code=key)

    def told(self, page):
        return page.run("document.getElementById('told').textContent")

    def test_readings_are_those_of_the_type_of_the_robot(self):
        world = json.loads(json.dumps(WORLD))
        world["types"]["watcher"] = {**world["types"]["runner"], "color": "gold"}
        world["models"][1]["type"] = "watcher"  # both types have a ranger "eye"
        with self.opened(world=world) as (_, page):
            for name in ("red", "blue", "red"):
                page.run(f"troupe.select('{name}')")
                page.wait("troupe.state().scanned")
            self.assertEqual(page.problems, [])

    def test_a_turn_keeps_the_position(self):
        with self.opened() as (_, page):
            page.wait("troupe.state().time > 2")
            self.pause(page)
            page.run("troupe.select('red')")
            place = [-3.0004321, -2.0001234]
            page.run(f"troupe.act({{do: 'move', robot: 'red', pose: [{place[0]}, {place[1]}, 0, 1]}})")
            page.wait("troupe.inspected()?.pose[3] === 1")
            self.assertEqual(page.run("troupe.inspected().pose.slice(0, 2)"), place)
            page.press("q", "KeyQ")
            page.wait("troupe.inspected().pose[3] > 1.2")
            self.assertEqual(page.run("troupe.inspected().pose.slice(0, 2)"), place, "it was not rounded to 1 mm")

            page.run("(back => { back.value = Number(back.max) - 1; back.oninput({target: back}); })(document.getElementById('back'))")
            page.wait("document.getElementById('now').textContent.endsWith(' s ago')")
            page.press("e", "KeyE")
            page.wait("!document.getElementById('told').hidden")
            self.assertIn("The page shows the past", self.told(page))
            self.press_button_of(page, "#now")
            page.run("troupe.act({do: 'disable', robot: 'blue'})")  # its answer comes after those of all earlier acts
            self.assertEqual(page.run("troupe.inspected().pose.slice(0, 2)"), place)
            self.assertGreater(page.run("troupe.inspected().pose[3]"), 1.2)
            self.assertEqual(page.problems, [])

    def test_bodies_above_the_floor_are_added_and_moved_at_their_height(self):
        world = json.loads(json.dumps(YARD))
        del world["types"]["bot"]["controller"]
        region = [[-4, -4], [4, 4]]
        world["populations"][0] |= {"count": 4, "reserve": 1, "place": {"rule": "grid", "region_m": region, "pitch_m": 4, "z_m": 0.7}}
        with self.opened(world=world) as (_, page):
            self.pause(page)
            page.run("(add => { add.selectedIndex = 1; add.onchange({target: add}); })(document.getElementById('add'))")
            x, y = page.run("troupe.pose('b0')")[:2]
            page.click(*page.run(f"troupe.screenPlace('b0', [{-x}, {-y}, 0])"))
            page.wait("troupe.state().robots === 5 && troupe.pose('b4')[3] === 0")
            for found, expected in zip(page.run("troupe.pose('b4')"), (0, 0, 0.7)):
                self.assertAlmostEqual(found, expected, delta=0.05)

            page.run("troupe.slant()")
            page.run("troupe.select('b4')")
            page.wait("troupe.inspected()?.robot === 'b4'")
            start, end = (page.run(f"troupe.screenPlace('b4', {shift})") for shift in ([0, 0, 0], [1, -0.5, 0]))
            page.drag(start, end)
            page.wait("Math.abs(troupe.pose('b4')[0]) > 0.5 && troupe.inspected().pose[0] > 0.5")
            for found, expected in zip(page.run("troupe.inspected().pose"), (1, -0.5, 0.7)):
                self.assertAlmostEqual(found, expected, delta=0.05)
            self.assertEqual(page.problems, [])

    def test_of_bodies_with_one_name_only_the_last_is_selected(self):
        world = json.loads(json.dumps({**WORLD, "same_names": "warn"}))
        world["models"][0]["name"] = "blue"
        with self.opened(world=world) as (_, page):
            self.pause(page)
            self.assertEqual(page.run("troupe.header.robots.name"), ["blue", "blue"])
            page.run("troupe.select('blue')")  # the first
            self.assertEqual(self.told(page), 'Several bodies have the name "blue"; only the last of them can be selected.')
            self.assertIsNone(page.run("troupe.state().selected"))
            page.drag((20, 20), (SIZE[0] - 20, SIZE[1] - 120), shift=True)
            page.wait("troupe.group().length === 1")
            page.run("(find => { find.value = 'blue'; find.onchange({target: find}); })(document.getElementById('find'))")
            page.wait("troupe.inspected()?.pose[0] > 0")
            self.assertEqual(page.run("troupe.state().selected"), "blue")
            self.assertEqual(page.problems, [])

    def test_a_world_without_robots_is_shown(self):
        with self.opened(world={"troupe": 1}) as (_, page):
            page.run("troupe.trails(10)")
            frame = page.run("troupe.state().frame")
            page.wait(f"troupe.state().frame > {frame + 5}")
            self.assertEqual(page.problems, [])

    def test_a_key_drives_only_while_it_is_pressed(self):
        turn = "troupe.inspected()?.components.find(c => c.name === 'velocity').fields.at(-1).values[0]"
        with self.opened("--rate", 5) as (view, page):
            page.run("troupe.select('red')")
            page.press("m", "KeyM")
            page.wait("document.getElementById('drive').checked")
            self.key(page, "keyDown", "ArrowLeft")
            page.wait(f"{turn} === 1.2")
            page.run("document.getElementById('color').focus()")
            self.key(page, "keyUp", "ArrowLeft")
            page.wait(f"{turn} === 0")
            for control in ("color", "drive-speed", "find", "back"):
                page.run(f"document.getElementById('{control}').focus()")
                self.key(page, "keyDown", "ArrowLeft")
                self.key(page, "keyUp", "ArrowLeft")
            page.run("document.getElementById('drive').focus()")  # a checkbox uses no arrow keys
            self.key(page, "keyDown", "ArrowRight")
            page.wait(f"{turn} === -1.2")
            page.run("window.dispatchEvent(new Event('blur'))")
            page.wait(f"{turn} === 0")
            holds = [json.loads(line)["speed"][2] for line in view.session.read_text().split("\n") if '"hold"' in line]
            self.assertEqual(holds, [0, 1.2, 0, -1.2, 0])
            self.assertEqual(page.problems, [])

    def test_an_error_does_not_stop_the_page(self):
        with self.opened("--rate", 0) as (_, page):
            page.run("document.getElementById('time').remove()")
            page.wait("!document.getElementById('problem').hidden")
            self.assertIn("Error in this page", page.run("document.getElementById('problem').textContent"))
            frame, tick = page.run("[troupe.state().frame, troupe.state().tick]")
            page.wait(f"troupe.state().frame > {frame + 5} && troupe.state().tick > {tick + 5}")
            self.assertEqual(len(page.problems), 1, page.problems)

    def test_commands_that_are_not_finite_are_shown(self):
        red = "document.querySelector('[data-command=red]')"
        with self.opened(world=YARD, script=NULL_COMMANDS) as (_, page):
            page.run("troupe.select('b0')")
            page.wait(f"{red}?.value === '–'")
            frame = page.run("troupe.state().frame")
            page.wait(f"troupe.state().frame > {frame + 5}")
            for text in ("–", "", "x", "1,"):
                page.run(f"(input => {{ input.value = '{text}'; input.onchange(); }})({red})")
                self.assertEqual(self.told(page), f'The command "red" must be numbers, separated by commas; found "{text}".')
            self.assertEqual(page.problems, [])

    def test_robots_far_outside_the_bounds_are_followed(self):
        world = {key: value for key, value in WORLD.items() if key != "bounds_m"}
        with self.opened(world=world) as (_, page):
            self.pause(page)
            page.run("document.getElementById('follow-all').click()")
            for slanted, x in ((False, 200), (True, 2000)):
                if slanted:
                    page.run("troupe.slant()")
                page.run(f"troupe.act({{do: 'move', robot: 'red', pose: [{x}, 30, 0, 0]}})")
                page.wait(f"Math.abs(troupe.pose('red')[0] - {x}) < 1e-2")
                for name in ("red", "blue"):
                    inside = f"(([x, y]) => x > 0 && y > 0 && x < {SIZE[0]} && y < {SIZE[1]})(troupe.screenPlace('{name}'))"
                    page.wait(inside, 30)
                page.wait("(([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]) > 200)"
                          "(['red', 'blue'].map(name => troupe.screenPlace(name)))", 30)
            self.assertEqual(page.problems, [])

    def test_a_click_while_a_drag_is_unanswered_moves_no_robot(self):
        with self.opened(script=SLOW_ANSWERS) as (view, page):
            self.pause(page)
            page.run("troupe.select('red')")
            page.wait("troupe.inspected()?.robot === 'red'")
            x, y = page.run("troupe.pose('red')")[:2]
            start, end = (page.run(f"troupe.screenPlace('red', {shift})") for shift in ([0, 0, 0], [-3 - x, -2 - y, 0]))
            page.drag(start, end)
            page.wait("Math.abs(troupe.pose('red')[1] + 2) < 0.05")
            page.click(*end)
            self.assertEqual(page.run("troupe.state().selected"), "red")
            page.run("troupe.step(1)")
            moves = [line for line in view.session.read_text().split("\n") if '"move"' in line]
            self.assertEqual(len(moves), 1, moves)

    def test_a_seed_is_a_whole_number(self):
        with self.opened() as (_, page):
            enter = "(text => { document.getElementById('seed').value = text; document.getElementById('restart').click(); })"
            for text in ("1.5", "-1", "1e3", "18446744073709551616"):
                page.run(f"{enter}('{text}')")
                self.assertEqual(self.told(page), f"The seed must be a whole number from 0 to 2^64 - 1, found {text}.")
            for text in ("9007199254740993", "18446744073709551615"):
                page.run(f"{enter}('{text}')")
                page.wait(f"window.troupe?.header.about.seed === '{text}'")
            self.assertEqual(page.problems, [])

    def test_controls_are_operated_by_keyboard(self):
        with self.opened() as (_, page):
            self.pause(page)
            page.press("Tab")
            page.run("document.getElementById('follow-all').focus()")
            page.press(" ", "Space")
            page.wait("troupe.following()[1]")
            self.assertFalse(page.run("troupe.state().playing"))
            page.run("troupe.select('red')")
            page.wait("document.querySelectorAll('#values .plottable[role=button]').length > 4")
            for count, key in ((1, "Enter"), (0, " ")):
                page.run("document.querySelector('#values > .plottable').focus()")
                page.press(key, "Space" if key == " " else key)
                self.assertEqual(page.run("document.querySelectorAll('#plots .plot').length"), count)
            self.assertFalse(page.run("troupe.state().playing"))
            self.assertEqual(page.problems, [])

    @unittest.skipUnless(HAS_IPV6, "the machine has no IPv6")
    def test_the_page_works_at_an_ipv6_address(self):
        with self.opened("--bind", "::1") as (view, page):
            self.assertTrue(view.address.startswith("http://[::1]:"))
            self.assertEqual(page.problems, [])

    def test_a_page_that_is_refused_says_why_and_tries_again(self):
        with View() as view, Page(PROGRAM, SIZE) as page:
            page.call("Page.addScriptToEvaluateOnNewDocument", source=f"{{{REFUSED_ONCE}}}")
            page.open_address(view.address)
            page.wait("document.getElementById('problem')?.textContent === "
                      "'The program refuses the connection: at most 16 viewers can be connected. The page tries again every 2 s.'")
            page.wait("window.troupe && troupe.state().tick > 2 && document.getElementById('problem').hidden")

    def test_the_address_of_the_next_run_can_be_opened_in_the_same_page(self):
        with Page(PROGRAM, SIZE) as page:
            with View() as view:
                page.open_address(view.address)
                page.wait("window.troupe && troupe.state().tick > 2")
            with View("--port", view.port) as view:
                page.wait("document.getElementById('problem').textContent.startsWith('This address has no valid token')")
                page.open_address(view.address)
                page.wait("window.troupe && troupe.state().tick > 2 && document.getElementById('problem').hidden")

    def test_a_page_that_loses_its_connection_is_reloaded_once(self):
        with self.opened(script=KEPT_SOCKETS) as (_, page):
            page.run("window.isOld = true, performance.now = () => 1e6, sockets.at(-1).close()")
            page.wait("document.getElementById('problem')?.textContent.startsWith('The program has ended')")
            page.wait("!window.isOld && window.troupe && troupe.state().tick > 2")
            page.run("window.isOld = true, performance.now = () => 1e3, sockets.at(-1).close()")
            page.wait("document.getElementById('problem').textContent.startsWith('The connection to the program was lost soon')")
            self.assertTrue(page.run("window.isOld"))

    def test_layers_and_colours_are_drawn(self):
        with View("--rate", 0, world=YARD) as view, Page(PROGRAM, SIZE) as page:
            page.open_address(view.address)
            page.wait("window.troupe && troupe.state().tick > 5")
            self.press_button_of(page, "#play")
            page.wait("!troupe.state().playing && troupe.state().line")

            def pixel(name, shift=(0, 0, 0)):
                """The colour on the screen of a robot, or of a point shifted from it by some metres."""
                x, y = (round(at) for at in page.run(f"troupe.screenPlace('{name}', {list(shift)})"))
                return Picture(page.screenshot((x - 2, y - 2, x + 2, y + 2))).at(2, 2)

            self.assertEqual(page.run("troupe.lines()"), 0)
            page.run("(select => { select.selectedIndex = 1; select.onchange({target: select}); })(document.getElementById('layers'))")
            page.wait("troupe.lines() > 0")
            page.wait("troupe.state().lines.radio.length > 0")
            line = page.run("troupe.state().lines.radio.slice(0, 6)")
            names = page.run("troupe.header.robots.name")
            x, y, z = page.run(f"troupe.pose('{names[0]}')")[:3]
            middle = [(line[0] + line[3]) / 2 - x, (line[1] + line[4]) / 2 - y, (line[2] + line[5]) / 2 - z]
            drawn = pixel(names[0], middle)
            page.press("l", "KeyL")  # all lines; there are no others
            page.press("l", "KeyL")  # none
            page.wait("troupe.lines() === 0")
            until = time.monotonic() + WAIT_S
            while pixel(names[0], middle) == drawn and time.monotonic() < until:
                pass
            self.assertNotEqual(pixel(names[0], middle), drawn, "a link was drawn between two robots")

            left, right = sorted(names, key=lambda name: page.run(f"troupe.pose('{name}')[0]"))[::len(names) - 1]
            own = pixel(left)
            page.run(f"troupe.act({{do: 'command', robot: '{left}', device: 'lamp', values: {{red: 1, green: 0, blue: 0, shows: 1}}}})")
            page.run("troupe.step(1)")
            page.wait("!troupe.state().playing && troupe.state().line")
            until = time.monotonic() + WAIT_S
            while pixel(left) == own and time.monotonic() < until:
                pass
            red, green, blue = pixel(left)
            self.assertTrue(red > 150 and green < 90 and blue < 90, (red, green, blue))

            page.run("troupe.color('pose.x')")
            page.wait("troupe.legend()[1] > troupe.legend()[0]")
            until = time.monotonic() + WAIT_S
            while pixel(left)[0] > 150 and time.monotonic() < until:
                pass
            ends = [pixel(left), pixel(right)]
            self.assertGreater(sum(abs(a - b) for a, b in zip(*ends)), 100, ends)
            self.assertEqual(page.problems, [])

    def test_parts_have_the_colours_that_they_show(self):
        mast = {"name": "mast", "size_m": [0.5, 0.5, 0.1], "pose": {"z_m": 0.2},
                "devices": [{"name": "lamp", "kind": "led", "shows": [0, 0.6, 0.2]}]}
        spot = {"name": "spot", "size_m": [0.015, 0.015, 0.01], "pose": {"x_m": 0.4, "z_m": 0.2},
                "devices": [{"name": "spot", "kind": "led", "shows": [0, 1, 0]}]}
        world = {"troupe": 1, "bounds_m": [[-2, -2], [2, 2]],
                 "types": {"bot": {"size_m": [1, 1, 0.2], "color": [0.1, 0.2, 0.8], "drive": {"kind": "diff"}, "parts": [mast, spot]},
                           "plain": {"size_m": [0.5, 0.5, 0.2], "color": [0.1, 0.2, 0.8], "drive": {"kind": "diff"}}},
                 "models": [{"name": "b", "type": "bot", "pose": {"x_m": 1}}, {"name": "p", "type": "plain", "pose": {"x_m": -1}},
                            {"name": "a", "type": "bot", "pose": {"x_m": -1, "y_m": 1}}]}
        with View("--rate", 0, world=world) as view, Page(PROGRAM, SIZE) as page:
            page.open_address(view.address)
            page.wait("window.troupe && troupe.state().tick > 5")
            self.press_button_of(page, "#play")
            page.wait("!troupe.state().playing && troupe.state().line")

            def pixel(name, shift):
                x, y = (round(at) for at in page.run(f"troupe.screenPlace('{name}', {list(shift)})"))
                return Picture(page.screenshot((x - 2, y - 2, x + 2, y + 2))).at(2, 2)

            def wait_for(name, shift, expected):
                until = time.monotonic() + WAIT_S
                while (found := pixel(name, shift)) != expected and time.monotonic() < until:
                    pass
                self.assertEqual(found, expected, name)

            top = (-0.12, -0.12, 0.3)
            wait_for("a", top, (0, 153, 51))
            wait_for("b", top, (0, 153, 51))
            page.run("troupe.act({do: 'command', robot: 'b', device: 'lamp', values: {red: 1, green: 0, blue: 0, shows: 1}})")
            page.run("troupe.step(1)")
            page.wait("!troupe.state().playing && troupe.state().line")
            wait_for("b", top, (255, 0, 0))
            wait_for("a", top, (0, 153, 51))
            x, y = (round(at) for at in page.run("troupe.screenPlace('a', [0.4, 0, 0.21])"))
            picture = Picture(page.screenshot((x - 5, y - 5, x + 5, y + 5)))
            near = [picture.at(column, row) for column in range(10) for row in range(10)]
            self.assertIn((0, 255, 0), near, "the small part has its colour")
            self.assertNotIn((0, 153, 0), near, "no edges, which are darker, hide the colour of the small part")
            for name, shift in (("a", (-0.4, -0.4, 0.2)), ("b", (-0.4, -0.4, 0.2)), ("p", (-0.12, -0.12, 0.2))):
                self.assertEqual(pixel(name, shift), (26, 51, 204), name)
            self.assertEqual(page.problems, [])

    def test_a_tablet_is_touched(self):
        with View() as view, Page(PROGRAM, (1024, 768), touch=True) as page:
            page.open_address(view.address)
            page.wait("window.troupe && troupe.state().tick > 2")
            page.touch(page.run("(({x, y, width, height}) => [x + width / 2, y + height / 2])"
                                "(document.querySelector('#play').getBoundingClientRect())"))
            page.wait("!troupe.state().playing && troupe.state().line")
            page.touch(page.run("troupe.screenPlace('red')"))
            page.wait("troupe.inspected()?.robot === 'red'")
            x, y = page.run("troupe.pose('red')")[:2]
            begin, end = (page.run(f"troupe.screenPlace('red', {shift})") for shift in ([0, 0, 0], [-3 - x, -2.5 - y, 0]))
            page.touch(*([a + (b - a) * i / 6 for a, b in zip(begin, end)] for i in range(7)))
            page.wait("Math.abs(troupe.pose('red')[0] + 3) < 0.05 && Math.abs(troupe.pose('red')[1] + 2.5) < 0.05")
            self.assertEqual(page.problems, [])

    def test_one_may_only_look(self):
        with View() as view, Page(PROGRAM, SIZE) as page:
            page.open_address(view.looking)
            page.wait("window.troupe")
            self.assertEqual(page.run("getComputedStyle(document.getElementById('play')).display"), "none")
            with view.open():
                page.wait("troupe.state().tick > 3")


if __name__ == "__main__":
    TROUPE = str(Path(sys.argv.pop(1)).resolve())
    if len(sys.argv) > 1 and "/" in sys.argv[1]:
        PICTURES = Path(sys.argv.pop(1)).resolve()
        PICTURES.mkdir(parents=True, exist_ok=True)
    unittest.main()
