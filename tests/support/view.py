"""A running `troupe view`, and worlds for it."""

import json
import os
import signal
import subprocess
import tempfile
from pathlib import Path

from tests.support.websocket import WAIT_S, Socket

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


class View:
    """A running `troupe view`."""

    program = None  # path of the program `troupe`; set it before the first view

    def __init__(self, *arguments, checkpoint_s=None, world=WORLD, environment=None, errors="errors"):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = Path(self.temporary.name)
        self.world = self.folder / "rooms.json"
        self.world.write_text(json.dumps(world))
        shown = self.world
        if checkpoint_s is not None:
            shown = self.folder / "c.h5"
            subprocess.run([View.program, "run", self.world, "--set", "/mortal=true", "--for", str(checkpoint_s), "--checkpoint", shown,
                            "--quiet"], check=True)
        self.errors = open(self.folder / errors, "w")
        self.process = subprocess.Popen([View.program, "view", shown, "--out", self.folder, *map(str, arguments)],
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
        subprocess.run([View.program, command[0], self.folder / command[1], "--session", session or self.session, "--hash-log", log, "--quiet",
                        *map(str, arguments)], check=True)
        lines = [line for line in log.read_text().split("\n") if line and not line.startswith("#")]
        return {int(line.split()[0]): line for line in lines}
