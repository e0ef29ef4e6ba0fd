#!/usr/bin/env python3
"""Tests `troupe view` without a browser: sessions, what viewers see and do, and attacks on its port.

    view_test.py TROUPE

The port is that of a page, which view_page_test.py tests.
"""

import importlib.util
import json
import os
import random
import resource
import shutil
import shlex
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
from tests.support.view import HAS_IPV6, WORLD, YARD, View  # noqa: E402
from tests.support.websocket import WAIT_S, Refused, Socket, request  # noqa: E402

TROUPE = None


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
            command = view.said().split("troupe view: this command repeats the session: ")[1].strip()
            self.assertEqual(command, f"troupe run {view.world} --spare 2 --session {view.session}")
            again = subprocess.run([TROUPE, *shlex.split(command)[1:], "--hash-log", view.folder / "again.log"],
                                   capture_output=True, text=True)
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertEqual((view.folder / "again.log").read_text().splitlines()[-1], last)
            refused = subprocess.run([TROUPE, "run", view.world, "--session", view.session], capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2)
            self.assertIn("rooms.session.jsonl:1: error: this run has other options than the run of the session: spare is 2 in the session, but not given in this run", refused.stderr)

    def test_a_checkpoint_is_taken_up_and_its_session_repeated(self):
        with View("--rate", 0, checkpoint_s=2) as view, view.open() as viewer:
            self.assertEqual(viewer.ask(do="move", robot="blue", pose=[3, -2, 0, 1])["type"], "done")
            self.assertEqual(viewer.ask(do="disable", robot="red")["type"], "done")
            last = view.end()
            self.assertIn(f"this command repeats the session: troupe resume {view.folder / 'c.h5'} --session {view.session}\n",
                          view.said())
            log = view.replayed(command=("resume", "c.h5"))
            self.assertEqual(log[int(last.split()[0])], last)
            refused = subprocess.run([TROUPE, "view", view.folder / "c.h5", "--seed", "7"], capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2)
            self.assertIn("c.h5: error: --seed, --raytracer, --robots and --spare are only for world files", refused.stderr)
            refused = subprocess.run([TROUPE, "view", view.folder / "c.h5", "--for", "1"], capture_output=True, text=True)
            self.assertEqual((refused.returncode, refused.stdout), (2, ""))
            self.assertIn("c.h5: error: the checkpoint was saved at 2 s, after the end of the run at 1 s: give a later --for",
                          refused.stderr)
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

    @unittest.skipUnless(os.geteuid() == 0, "only root can mount a file system")
    def test_a_page_that_cannot_be_written_is_removed(self):
        with tempfile.TemporaryDirectory() as folder:
            world = Path(folder) / "w.json"
            world.write_text('{"troupe": 1}')
            full = Path(folder) / "full"
            full.mkdir()
            script = ('mount -t tmpfs -o size=4k none "$0" || exit 77; head -c 4096 /dev/zero > "$0/all"; '
                      'TMPDIR="$0" "$@"; code=$?; ls "$0"; exit $code')
            refused = subprocess.run(["unshare", "--mount", "sh", "-c", script, full, TROUPE, "view", world, "--open", "--out", folder],
                                     capture_output=True, text=True)
            if refused.returncode == 77 or "unshare" in refused.stderr:
                self.skipTest("NOT TESTED: a file system cannot be mounted here")
            self.assertEqual(refused.returncode, 1)
            self.assertIn(".html: error: this temporary file, which --open needs, cannot be written: the disk may be full",
                          refused.stderr)
            self.assertEqual(refused.stdout.splitlines()[-1], "all")  # the last file of the folder

    def test_the_browser_gets_no_socket_no_ignored_signals_and_a_session_of_its_own(self):
        with tempfile.TemporaryDirectory() as folder:
            opener = Path(folder) / "xdg-open"
            opener.write_text(f"#!/bin/sh\nls -l /proc/$$/fd > {folder}/part\necho session $(cut -d ' ' -f 6 /proc/$$/stat) $$ >> {folder}/part\n"
                              f"grep SigIgn /proc/$$/status >> {folder}/part\nmv {folder}/part {folder}/opened\n")
            opener.chmod(0o755)
            with View("--open", environment={"PATH": f"{folder}:{os.environ['PATH']}"}):
                opened = Path(folder) / "opened"
                until = time.monotonic() + WAIT_S
                while not opened.exists() and time.monotonic() < until:
                    time.sleep(0.02)
                said = opened.read_text()
        self.assertEqual([line for line in said.splitlines() if "socket:" in line and int(line.split(" -> ")[0].split()[-1]) > 2], [])
        session, process = said.split("session")[1].split()[:2]
        self.assertEqual(session, process)
        ignored = int(said.split("SigIgn:")[1], 16)
        self.assertEqual([name for name in ("SIGPIPE", "SIGXFSZ") if ignored >> getattr(signal, name) - 1 & 1], [])

    # The address space allows the stack of one further thread, that of the server.
    def test_without_a_thread_that_waits_for_the_browser_the_view_goes_on(self):
        with tempfile.TemporaryDirectory() as folder:
            world = Path(folder) / "rooms.json"
            world.write_text(json.dumps(WORLD))
            opener = Path(folder) / "xdg-open"
            opener.write_text("#!/bin/sh\nkill -INT $PPID\n")
            opener.chmod(0o755)

            def limited(*arguments):
                limits = 'ulimit -s 4000000 && ulimit -v 6000000 || exit 77; exec "$0" "$@"'
                return subprocess.run(["sh", "-c", limits, TROUPE, *arguments], capture_output=True, text=True, timeout=WAIT_S,
                                      env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"})

            if limited("--version").returncode != 0:
                self.skipTest("NOT TESTED: the limits cannot be set here")
            view = limited("view", world, "--open", "--threads", "1", "--out", folder)
            notice = ("troupe view: ending; a second Ctrl-C or SIGTERM ends the program at once\n"
                      f"troupe view: this command repeats the session: troupe run {world} --session {folder}/rooms.session.jsonl\n")
            self.assertEqual((view.returncode, view.stderr), (3, notice))

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

    def test_a_full_disk_under_the_session_ends_the_view_and_viewers_are_told_why(self):
        with View("--rate", 0) as view, view.open() as viewer, view.open(view.look_token) as other:
            viewer.ask(do="pause")
            _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
            resource.prlimit(view.process.pid, resource.RLIMIT_FSIZE, (view.session.stat().st_size, hard))
            viewer.send('{"do": "move", "robot": "red", "pose": [-3, -2, 0, 1]}')
            for each in (viewer, other):
                with self.assertRaisesRegex(ConnectionError, "^the server closed the connection: the session file cannot be "
                                                             "written: File too large$"):
                    while True:
                        if isinstance(each.receive(), bytes):
                            each.send('{"do": "drawn"}')
            self.assertEqual(view.process.wait(WAIT_S), 1)
            self.assertIn("rooms.session.jsonl: error: cannot be written: File too large", view.said())

    def test_restarts_begin_a_limited_number_of_sessions(self):
        with View("--rate", 0) as view, view.open() as viewer:
            viewer.ask(do="pause")
            answers = [viewer.ask(do="restart") for _ in range(1001)]
            self.assertEqual({answer["type"] for answer in answers[:1000]}, {"done"})
            self.assertEqual(answers[1000]["reason"], "the files that viewers requested have reached the number 1000, the limit of a "
                                                      "view: end this view, and start another one")
            self.assertEqual(viewer.ask(do="checkpoint")["reason"], answers[1000]["reason"])
            self.assertEqual(len(list(view.folder.glob("*.jsonl"))), 1001)
            self.assertEqual(viewer.ask(do="step", ticks=3)["type"], "done")

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
        page = (ROOT / "docs" / "live-protocol.md").read_text()
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

    def test_a_refusal_that_cannot_be_printed_does_not_end_the_view(self):
        with View(errors="/dev/full") as view:
            self.assertIn(b" 403 ", request(view.port, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"))
            with view.open() as viewer:
                viewer.state()
            view.end()

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
        else:
            self.fail("a viewer that leaves makes no room for another")

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
        for body in ("Content-Length: 5\r\n\r\nhello", "Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n0\r\n\r\n"):
            answer = request(self.view.port, f"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n{body}")
            self.assertIn(b" 405 ", answer[:20])
            self.assertIn(b"\r\nAllow: GET\r\n", answer)
        request(self.view.port, b"\x16\x03\x01\x02\x00" + os.urandom(200))
        request(self.view.port, "GET / HTTP/1.1\r\n" + "x: y\r\n" * 5000 + "\r\n")
        status, answer = self.get()
        self.assertEqual(status, 200)
        self.assertIn(b"connect-src ws://127.0.0.1;", answer)
        self.assertNotIn(self.view.token.encode(), answer)


if __name__ == "__main__":
    TROUPE = View.program = str(Path(sys.argv.pop(1)).resolve())
    unittest.main()
