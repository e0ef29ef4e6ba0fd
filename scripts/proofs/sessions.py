"""Records sessions in random worlds. A viewer connects to the live view of a simulation, as a browser does (docs/live.md).
Between ticks, the viewer moves, drives, commands, adds and removes robots, and sets parameters. Troupe records these acts
in a session file. A run that repeats the session must give the same bits."""

import json
import pathlib
import random
import sys
import threading

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "tests" / "support"))
from websocket import Socket  # noqa: E402

ACTS = ("move", "speed", "hold", "release", "command", "add", "remove", "disable", "enable", "set")
# Time that the viewer waits for an answer on a busy machine, s.
TIMEOUT_S = 300


class Viewer(threading.Thread):
    """A thread that connects to a view as a browser does, steps the simulation tick by tick, and makes up to three random acts
    before each tick. Meanwhile another thread must call step() of the simulation `ticks` times; each call waits for this
    viewer. world: the JSON world; seed: seed of the acts.

    done        the kinds of acts, such as "move", that were carried out at least once; an act may also be refused, for example
                because a place was occupied
    checkpoint  the name of the checkpoint file that was saved in the session, or None
    error       the exception that ended the thread, or None
    """

    def __init__(self, view, world, ticks, seed):
        super().__init__(daemon=True)
        self.draws = random.Random(f"acts {seed}")
        self.world, self.ticks = world, ticks
        self.save_at = self.draws.randint(1, ticks)  # the tick at which a checkpoint is saved
        self.done, self.checkpoint, self.error = set(), None, None
        self._last_id = 0
        host, token = view.address.removeprefix("http://").split("/#")
        self.socket = Socket(int(host.rsplit(":", 1)[1]), timeout=TIMEOUT_S)
        self.socket.send(token)
        hello = self.socket.receive()
        self.robots, self.populations = hello["header"]["robots"]["name"], hello["populations"]
        # Before its first tick, a simulation that a program steps does not wait for viewers. The server itself answers the empty
        # message, after it has queued the others.
        self.first = [self._send(self._act()) for _ in range(self.draws.randint(0, 2))] + [self._send({"do": "step"})]
        self.socket.send("{}")
        while self._receive().get("type") != "refused":
            pass

    def run(self):
        try:
            for message in self.first:
                self._answer(message)
            for tick in range(1, self.ticks):
                for _ in range(self.draws.choice((0, 0, 1, 2, 3))):
                    self._answer(self._send(self._act()))
                if tick + 1 == self.save_at:  # the checkpoint is saved after a tick
                    self.checkpoint = self._answer(self._send({"do": "checkpoint"})).get("file")
                else:
                    self._answer(self._send({"do": "step"}))
        except ConnectionError:
            pass  # a tick failed, and the program has closed the view
        except Exception as error:  # reported by the thread that steps
            self.error = error
            self.socket.send('{"do": "play"}')

    def _send(self, message):
        self._last_id += 1
        self.socket.send(json.dumps({"id": self._last_id, **message}))
        return {"id": self._last_id, **message}

    def _receive(self):
        """Returns the next message of the server: the parsed text of a text message, or {} for the data of a picture, after
        acknowledging the picture."""
        message = self.socket.receive()
        if isinstance(message, dict):
            return message
        self.socket.send('{"do": "drawn"}')
        return {}

    def _answer(self, message):
        while True:
            answer = self._receive()
            if answer.get("type") in ("done", "refused") and answer.get("id") == message["id"]:
                if answer["type"] == "done" and message["do"] in ACTS:
                    self.done.add(message["do"])
                return answer

    # ---- random acts

    def _act(self):
        draws = self.draws
        robot = draws.choice(self.robots) if self.robots else "none"
        what = draws.choice(ACTS)
        if what == "remove" and draws.random() < 0.6:
            what = "move"
        message = {"do": what, "robot": robot}
        pose = [draws.uniform(-5, 5), draws.uniform(-5, 5), 0, draws.uniform(-4, 4)]
        if what == "move":
            message["pose"] = pose
        elif what in ("speed", "hold"):
            message["speed"] = [draws.uniform(-1, 1), draws.uniform(-0.3, 0.3), draws.uniform(-2, 2)]
        elif what == "add":
            message = {"do": what, "population": draws.choice(self.populations or ["none"]), "pose": pose}
        elif what == "command":
            message.update(self._command(robot))
        elif what == "set":
            message = {"do": what, **self._setting()}
        return message

    def _command(self, robot):
        """Returns the members `device` and `values` of an act `command`: a device of the robot, and random values of a field
        of the device's command."""
        nothing = {"device": "none", "values": {"none": [0]}}
        if self._last_id < 4 or self._answer(self._send({"do": "inspect", "robot": robot}))["type"] != "done":
            return nothing  # before the first tick, there is no answer
        inspected = {}
        while inspected.get("robot") != robot:
            inspected = self._receive().get("inspected", {})
        commands = {name: fields for name, fields in inspected.get("commands", {}).items() if fields}
        if not commands:
            return nothing
        device = self.draws.choice(list(commands))
        field, values = self.draws.choice(list(commands[device].items()))
        return {"device": device, "values": {field: [self.draws.choice((0, 1, self.draws.random())) for _ in values]}}

    def _setting(self):
        """Returns the members of an act `set`: a type, and a new value for one of its numeric parameters."""
        name = self.draws.choice([name for name in self.world["types"] if name != "wall"] or ["none"])
        nothing = {"type": name, "drive": {}}
        if self._last_id < 4:
            return nothing
        parts = self._answer(self._send({"do": "parameters", "type": name})).get("parameters", [])
        choices = []
        for part in parts:
            (key, values), = part.items()
            numbers = [each for each, value in values.items() if isinstance(value, (int, float)) and not isinstance(value, bool)]
            choices += [(key, values, number) for number in numbers]
        if not choices:
            return nothing
        key, values, number = self.draws.choice(choices)
        changed = {each: values[each] for each in ("name", "kind") if each in values}
        value = values[number] * self.draws.choice((1, 0.5, 2))
        return {"type": name, key: {**changed, number: int(value) if isinstance(values[number], int) else value}}
