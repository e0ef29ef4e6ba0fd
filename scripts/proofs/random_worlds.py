"""Makes small random worlds that contain every kind of part that a world can have (kinds.py).

The seed and the index of a world determine the world. Each world has a focus: a kind of part (drive, sensor, device or
controller) and an event that happens to a body with a part of this kind, such as the death of the body. Successive worlds
have different foci, so that every pair of kind and event occurs. Everything else in a world is random.
"""

import math
import random

from .edge_cases import add_edge_cases
from .parameters import COLORS, SET_OF, Parameters, Values, rounded, settable

TICKS = (15, 90)
TICK_S = (0.1, 0.1, 0.05, 0.02, 0.25, 1.0)
MOST_BODIES = 30
EVENTS = ("born", "dies", "disabled", "enabled", "moved", "set", "carried", "resumed")
PART_FAMILIES = ("drive", "sensor", "device", "controller")
PLAN = "plan.pgm"  # an image of walls, in the folder of the world
EDGE_CASES = 0.3  # the probability that a world has edge cases (edge_cases.py)

# Sensors and devices that controllers need or can use: (kind, required parameters).
SCANNER = ("ranger", {"transducers": [{"range_max_m": 2, "fov_deg": 180, "samples": 9}]})
RING = ("ranger", {"transducers": [{"pose": {"heading_deg": 45 * i}, "range_max_m": 2} for i in range(8)]})
RING_OF_12 = ("ranger", {"transducers": [{"pose": {"heading_deg": 30 * i}, "range_max_m": 2} for i in range(12)]})
RADIO = ("radio", {"payload": 8})
GROUND_RADIO_SCANNER = [("ground", {}), RADIO, SCANNER]
FORAGER = [SCANNER, ("flags", {}), ("power_pack", {}), ("power_contact", {})]
NEEDS = {
    "expand": [SCANNER], "expand_pioneer": [RING], "expand_swarm": [RING_OF_12], "wander": [SCANNER], "script": [], "waypoints": [],
    "source": [("flags", {})], "sink": [("flags", {})], "fasr": FORAGER, "fasr2": [*FORAGER, ("fiducial", {})],
    "pioneer_flocking": [RING, ("fiducial", {})], "dynamic": [], "lasernoise": [SCANNER], "rasterize": [],
    "operate": [("gripper", {})], "collector": [SCANNER, ("fiducial", {}), ("gripper", {}), ("power_pack", {})],
    "gradient": [RADIO, SCANNER, ("led", {})], "radio_flocking": [RADIO, SCANNER],
    "collective_perception": [*GROUND_RADIO_SCANNER, ("led", {})], "beeclust": GROUND_RADIO_SCANNER,
    "chain": [RADIO, SCANNER, ("led", {})], "brazil_nut": [("light_sensor", {"directions": 8}), RADIO],
    "clustering": [SCANNER], "informed_aggregation": GROUND_RADIO_SCANNER,
}
# The devices of a controller that is not listed above.
EVERYTHING = [RING, SCANNER, RADIO, ("ground", {}), ("light_sensor", {"directions": 8}), ("fiducial", {}), ("flags", {}),
              ("power_pack", {}), ("gripper", {}), ("led", {})]
COMPANIONS = {"power_contact": "power_pack", "spawner": "flags"}
# Controllers of bodies without a drive.
STANDS = {"source", "sink"}
MODELS_NEEDED = {"fasr": ("source", "sink"), "fasr2": ("red_source", "red_sink", "green_source", "green_sink"),
                 "collector": ("sink", "sink1")}


def focus_of(pairs, seed, index):
    """Returns the focus of the world with this index: one of `pairs`, the triples (family, kind, event) of pairs_of().
    Successive worlds take all pairs in turn, in an order that depends on the seed."""
    order = list(range(len(pairs)))
    random.Random(f"foci {seed} {index // len(pairs)}").shuffle(order)
    return pairs[order[index % len(pairs)]]


def pairs_of(kinds):
    """Returns every possible triple (family, kind, event); the event `set` only for kinds with parameters that can be set."""
    return [(family, name, event) for family in PART_FAMILIES for name, kind in sorted(kinds.of(family).items())
            for event in EVENTS if event != "set" or settable(kind)]


class Generator(Parameters):
    """Makes one world. After construction, `world` is the JSON document and `ticks` the length of its run. focus: (family,
    kind, event), as focus_of() returns it."""

    def __init__(self, kinds, seed, index, focus):
        self.kinds = kinds
        self.draws = random.Random(f"world {seed} {index}")
        self.values = Values(kinds, self.draws)
        self.focus = focus
        self.ticks = self.draws.randint(*TICKS)
        self.tick_s = self.draws.choice(TICK_S)
        self.half = rounded(self.draws.uniform(3.5, 6))
        self.bodies = 0
        self.places = []  # poses to which interventions move bodies
        self.world = {"troupe": 1, "seed": self.draws.randint(0, 2**63), "tick_s": self.tick_s,
                      "types": {}, "models": [], "populations": [], "at": [], "faults": [], "measures": []}
        self._spots = self._ring()
        self._build()
        edges = random.Random(f"edges {seed} {index}")  # a stream of its own: edge cases leave the rest of the world as it is
        if edges.random() < EDGE_CASES:
            add_edge_cases(self.world, edges, rounded(self.tick_s * self.ticks), self.half)
        for key in ("at", "faults", "measures", "models", "populations"):
            if not self.world[key]:
                del self.world[key]

    # ---- types

    def device(self, family, name, given=()):
        kind = self.kinds.of(family)[name]
        one = {"kind": name, **self.parameters(kind, dict(given))}
        if "pose" not in one and family == "sensor":
            one["pose"] = {"x_m": 0.05, "z_m": rounded(self.draws.uniform(0.05, 0.25))}
        if self.chance(0.25):
            key = "update_period_s" if "period_s" in kind.parameters else "period_s"
            one[key] = rounded(self.tick_s * self.draws.choice((1, 2, 3, 2.5, 7)))
        if self.chance(0.04):
            one["active"] = False
        return one

    def body(self):
        if self.chance(0.7):
            edge = self.draws.choice((0.1, 0.2, 0.2, 0.3, 0.45))
            return {"size_m": [edge, rounded(edge * self.draws.uniform(0.6, 1)), rounded(self.draws.uniform(0.1, 0.4))]}
        if self.chance(0.5):
            return {"blocks": [{"points_m": [[-0.1, -0.1], [0.15, -0.1], [0.15, 0.1], [0, 0.02], [-0.1, 0.1]], "z_m": [0.01, 0.2]}]}
        return {"blocks": [{"points_m": [[-0.15, -0.1], [0.05, -0.1], [0.05, 0.1], [-0.15, 0.1]], "z_m": [0, 0.15]},
                           {"points_m": [[0.05, 0.07], [0.12, 0.07], [0.12, 0.1], [0.05, 0.1]], "z_m": [0, 0.05]}]}

    def wanted_devices(self, controller):
        """Returns (kind, parameters) of the devices that a controller needs, and of up to three random others."""
        wanted = list(NEEDS.get(controller, EVERYTHING)) if controller else []
        rest = [*self.kinds.of("sensor"), *self.kinds.of("device")]
        for _ in range(self.draws.choice((0, 1, 1, 2, 3))):
            wanted.append((self.draws.choice(rest), {}))
        return wanted

    def _with_companions(self, devices):
        """Yields the devices, (kind, parameters), and, before a device that needs another one on the same body (COMPANIONS), also
        that one."""
        for kind, given in devices:
            if kind in COMPANIONS:
                yield COMPANIONS[kind], {}
            yield kind, given

    def robot(self, name, part=None, mortal_pack=False):
        """Adds a type of this name that contains the given part, (family, kind), and returns the name. The type has a drive
        unless its controller is one of STANDS. mortal_pack: adds a power pack; the body dies when the pack is empty."""
        family, wanted = part or (None, None)
        controllers = self.kinds.of("controller")
        controller = wanted if family == "controller" else self.draws.choice([*controllers, None, "waypoints", "wander", "script"])
        moves = controller not in STANDS
        body = self.body()
        one = {**body, "color": self.draws.choice(COLORS)}
        if moves:
            kind = wanted if family == "drive" else self.draws.choice(list(self.kinds.of("drive")))
            one["drive"] = {"kind": kind, **self.parameters(self.kinds.of("drive")[kind])}
            if self.chance(0.15):
                one["drive"]["period_s"] = rounded(self.tick_s * self.draws.choice((1, 2, 3.5)))
        devices = self.wanted_devices(controller)
        if family in ("sensor", "device"):
            devices.append((wanted, {}))
        if mortal_pack:
            devices.append(("power_pack", {"when_empty": "die"}))
        one["sensors"], one["devices"] = [], []
        for number, (kind, given) in enumerate(self._fitting(self._with_companions(devices))):
            where = "sensor" if kind in self.kinds.of("sensor") else "device"
            made = self.device(where, kind, given)
            if kind == "spawner" and "population" not in made:
                continue
            made["name"] = f"{kind}{number}"
            one[f"{where}s"].append(made)
        self._mount(one)
        if controller:
            one["controllers"] = self.controllers(controller, one)
        self._marks(one)
        self.world["types"][name] = {key: value for key, value in one.items() if value != []}
        return name

    def _fitting(self, devices):
        """Yields those of the devices, (kind, parameters), that fit on one body: at most one device with an outline, because
        outlines would overlap, and at most one device of each of the kinds power_pack, flags, led and brush."""
        alone = set()
        for kind, given in devices:
            group = "body" if kind in ("gripper", "wheels", "actuator") else kind
            if group in ("body", "power_pack", "flags", "led", "brush"):
                if group in alone:
                    continue
                alone.add(group)
            yield kind, given

    def _mount(self, one):
        """Mounts one of the sensors of a type on an actuator of the type, if it has one, with a probability of one half."""
        actuators = [device["name"] for device in one["devices"] if device["kind"] == "actuator"]
        if actuators and one["sensors"] and self.chance(0.5):
            self.draws.choice(one["sensors"])["on"] = actuators[0]

    def controllers(self, controller, one):
        made = []
        if controller in self.kinds.of("controller"):
            made.append({"kind": controller, **self.parameters(self.kinds.of("controller")[controller])})
            if one.get("drive", {}).get("kind") != "omni":
                for goal in made[0].get("goals", ()):  # other drives do not go straight
                    goal.pop("speed_mps", None)
        operable = _operable(one)
        if operable and controller != "collector" and (controller == "operate" or self.chance(0.6)):
            orders = self._orders(operable)
            if controller == "operate":
                made[0]["orders"] = orders
            else:
                made.append({"kind": "operate", "orders": orders})
        if controller is not None and self.chance(0.08):
            made.append({"kind": "rasterize"})
        if made and "drive" not in one and self.chance(0.2):
            made[0]["period_s"] = rounded(2 * self.tick_s)
        return [each for each in made if each["kind"] != "operate" or each["orders"]]

    def _orders(self, operable):
        """Returns random orders (timed commands) of an `operate` controller for some of these devices, in ascending order of
        their times."""
        orders, at = [], 0
        for _ in range(self.draws.randint(1, 4)):
            device = self.draws.choice(operable)
            at = rounded(at + self.tick_s * self.draws.randint(0, 15))
            order = self.draws.choice(("open", "close", "up", "down") if device["kind"] == "gripper" else ("go_to", "speed"))
            orders.append({"at_s": at, "device": device["name"], "order": order,
                           **({"value": rounded(self.draws.uniform(0, 0.3))} if order in ("go_to", "speed") else {})})
        return orders

    def _marks(self, one):
        if self.chance(0.3):
            one["fiducial_return"] = self.draws.choice((1, 2, 7))
        if self.chance(0.1):
            one["fiducial_key"] = 3
        if self.chance(0.25):
            one["gripper_return"] = True
        if self.chance(0.05):
            one["obstacle"] = False
        if self.chance(0.1):
            one["ranger_return"] = self.draws.choice((-1, 0.5, 2))

    # ---- the scene

    def _ring(self):
        """Returns positions (x, y), m, for single models, in random order: about 1.4 m apart, on a square outside the area of
        populations."""
        edge = self.half - 0.9
        count = max(1, int(2 * edge / 1.4))
        line = [-edge + 2 * edge * i / count for i in range(count)]
        spots = [(x, -edge) for x in line] + [(edge, y) for y in line] + [(-x, edge) for x in line] + [(-edge, -y) for y in line]
        self.draws.shuffle(spots)
        return spots

    def model(self, name, of_type, heading=None):
        """Adds a single body at the next position of _ring(), and returns its entry in the world; None if no position is left
        or the world has MOST_BODIES bodies. heading: degrees; None: random."""
        if not self._spots or self.bodies >= MOST_BODIES:
            return None
        x, y = self._spots.pop()
        one = {"name": name, "type": of_type, "pose": {"x_m": rounded(x), "y_m": rounded(y),
               "heading_deg": self.draws.choice((0, 90, 37, -120)) if heading is None else heading}}
        self.world["models"].append(one)
        self.bodies += 1
        return one

    def _surround(self):
        world, half = self.world, self.half
        how = self.draws.choice(("bounds", "walls", "walls", "plan"))
        self.inner = half - 1.7
        if how == "bounds":
            world["bounds_m"] = [[-half, -half], [half, half]]
        elif how == "walls":
            world["types"]["wall"] = {"size_m": [rounded(2 * half + 0.3), 0.1, 0.5], "color": "gray30"}
            for i in range(4):
                angle = i * math.pi / 2
                world["models"].append({"name": f"wall{i}", "type": "wall", "pose": {
                    "x_m": rounded(half * math.cos(angle)), "y_m": rounded(half * math.sin(angle)), "heading_deg": 90 * i + 90}})
            if self.chance(0.5):
                world["bounds_m"] = [[-half - 1, -half - 1], [half + 1, half + 1]]
        else:
            world["floorplans"] = [{"name": "cave", "bitmap": PLAN, "size_m": [2 * half, 2 * half, 0.6], "boundary": self.chance(0.5)}]

    def place(self):
        """Returns a random placement rule with its parameters, for bodies near the centre."""
        rule = self.draws.choice(self.kinds.rules)
        inner = self.inner
        region = [[rounded(-inner), rounded(-inner)], [rounded(inner), rounded(inner)]]
        one = {"rule": rule, "region_m": region}
        if rule == "grid":
            one["pitch_m"] = rounded(self.draws.uniform(0.75, 0.95))
            if self.chance(0.3):
                one["jitter_m"] = 0.05
            one["spill_m"] = region
        elif rule == "gaussian":
            one.update(mean_m=[0, 0], deviation_m=[rounded(inner / 2), rounded(inner / 2)])
        elif rule == "poisson_disc":
            one["distance_m"] = rounded(self.draws.uniform(0.2, 0.7))
        elif rule == "free_floor":
            one["cell_m"] = 0.1
            one["from_m"] = [0, 0] if self.chance(0.3) else [rounded(inner), rounded(-inner)]
        if self.chance(0.2):
            one["polygon_m"] = [[-inner, -inner], [inner, -inner], [inner, 0.5 * inner], [0, inner], [-inner, inner]]
            one["polygon_m"] = [[rounded(x), rounded(y)] for x, y in one["polygon_m"]]
        if self.chance(0.3):
            one["heading_deg"] = self.draws.choice((0, 45, -170))
        elif self.chance(0.3):
            one["heading"] = "random"
        return one

    def population(self, name, of_type, count, reserve):
        count = min(count, MOST_BODIES - self.bodies)
        self.bodies += count
        one = {"name": name, "type": of_type, "count": count, "place": self.place()}
        if reserve:
            one["reserve"] = reserve
        if self.chance(0.2):
            one["color"] = "random"
        self.world["populations"].append(one)

    def _build(self):
        world, draws = self.world, self.draws
        self._surround()
        if self.chance(0.4):
            world["ranging"] = draws.choice(self.kinds.ranging)
            if self.chance(0.3):
                world["resolution_m"] = draws.choice((0.02, 0.1))
        family, kind, event = self.focus
        reserve = draws.randint(2, 6) if event in ("born", "resumed") or kind == "spawner" or self.chance(0.6) else 0
        self.reserves = ["f"] if reserve else []
        swarm = self.robot("focus", (family, kind), mortal_pack=event == "dies" and self.chance(0.2))
        self.population("f", swarm, draws.randint(1, 6), reserve)
        for i in range(draws.choice((0, 1, 1, 2))):
            other = self.robot(f"other{i}")
            self.population(f"o{i}", other, draws.randint(0, 5), draws.choice((0, 0, 2, 4)))
        if self.chance(0.4):
            world["types"]["puck"] = {"size_m": [0.1, 0.1, 0.1], "color": "gold", "fiducial_return": 1, "gripper_return": True,
                                      "pushable": self.chance(0.7)}
            self.population("p", "puck", draws.randint(1, 8), draws.choice((0, 3)))
        self._fixtures()
        if event == "carried" or self.chance(0.15):
            self._grips("focus" if event == "carried" else draws.choice([name for name in world["types"] if name != "wall"]))
        self._happenings(event)
        self._faults()
        self._measures()
        if self.chance(0.2):
            world["mortal"] = True
        if self.chance(0.3):
            world["contacts"] = True
        world["overlaps"] = "warn"

    def _fixtures(self):
        """Adds the sources and sinks that controllers in this world look for by name (MODELS_NEEDED). At random, also adds bodies
        with devices of other kinds: a nest, which spawns bodies of a reserve; a pit, which removes bodies; a pad, which charges
        power packs; a lamp; and a black tile with an LED."""
        world = self.world
        used = {controller["kind"] for one in world["types"].values() for controller in one.get("controllers", ())}
        flat = {"size_m": [0.5, 0.5, 0.01], "obstacle": False, "ranger_return": -1}
        for controller in sorted(used & MODELS_NEEDED.keys()):
            for name in MODELS_NEEDED[controller]:
                if any(model["name"] == name for model in world["models"]):
                    continue
                kind = "source" if "source" in name else "sink"
                world["types"].setdefault(kind, {**flat, "devices": [{"name": "flags", "kind": "flags", "most": 10}],
                                                 "controllers": [{"kind": kind}]})
                self.model(name, kind)
        if self.reserves and self.chance(0.5):
            world["types"]["nest"] = {**flat, "devices": [{"name": "flags", "kind": "flags"}, {
                "name": "nest", "kind": "spawner", **self.parameters(self.kinds.of("device")["spawner"])}]}
            self.model("nest", "nest")
        if self.chance(0.2):
            world["types"]["pit"] = {**flat, "devices": [{"name": "pit", "kind": "remover", "radius_m": 0.5}]}
            self.model("pit", "pit")
        if self.chance(0.3):
            world["types"]["pad"] = {**flat, "fiducial_return": 2, "devices": [
                {"name": "mains", "kind": "power_pack", "infinite": True}, {"name": "plug", "kind": "power_contact", "give_W": 60}]}
            self.model("pad", "pad")
        if self.chance(0.3):
            world["types"]["lamp"] = {"size_m": [0.1, 0.1, 0.4], "devices": [
                {"name": "lamp", "kind": self.draws.choice(("blinkenlight", "lightindicator"))}]}
            self.model("lamp", "lamp")
        if self.chance(0.3):
            world["types"]["tile"] = {**flat, "color": "black", "devices": [{"name": "led", "kind": "led"}]}
            self.model("tile", "tile")

    def _grips(self, of_type):
        """Adds one or two bodies of the type `catcher`, each with a body of the type `of_type` between the paddles of its
        gripper; the gripper closes on this body."""
        world = self.world
        world["types"][of_type]["gripper_return"] = True
        world["types"]["catcher"] = {
            "size_m": [0.2, 0.2, 0.3], "drive": {"kind": self.draws.choice(("diff", "omni"))}, "devices": [
                {"name": "hand", "kind": "gripper", "pose": {"x_m": 0.55, "z_m": 0.02}, "size_m": [0.9, 1.0, 0.3], "autosnatch": True}],
            "controllers": [{"kind": "script", "legs": [{"until_s": rounded(self.tick_s * self.ticks), "forward_mps": 0.02}]}]}
        for i in range(self.draws.choice((1, 1, 2))):
            catcher = self.model(f"catcher{i}", "catcher", heading=0)
            if catcher is None or self.bodies >= MOST_BODIES:
                return
            # The paddles reach from 0.1 + 0.306 = 0.406 m to 1 m in front of the catcher's origin, 0.8 m apart.
            x, y = catcher["pose"]["x_m"], catcher["pose"]["y_m"]
            if x > 0:
                catcher["pose"]["heading_deg"] = 180
            world["models"].append({"name": f"prey{i}", "type": of_type, "pose": {
                "x_m": rounded(x + (-0.72 if x > 0 else 0.72)), "y_m": y}})
            self.bodies += 1

    # ---- events

    def time(self, low=1, high=None):
        return rounded(self.tick_s * self.draws.randint(low, max(low, high or self.ticks - 2)))

    def whom(self, many=True):
        """Returns the keys with which an intervention chooses a random group of bodies. Most groups contain bodies of the type
        `focus`. many: whether the group may be limited to a number or a fraction of these bodies."""
        populations = [each["name"] for each in self.world["populations"] if each["count"]]
        whom = {"population": "f"} if self.chance(0.7) else {"population": self.draws.choice(populations)}
        if self.chance(0.15):
            whom = {"type": "focus"}
        if many and self.chance(0.6):
            whom.update({"count": self.draws.randint(1, 3)} if self.chance(0.5) else {"share": self.draws.choice((0.3, 0.5, 1))})
        return whom

    def _happenings(self, focus):
        """Adds the entries of `at`: those that cause the event of the focus, and up to five random others."""
        actions = self.kinds.actions
        meant = {"born": ["add"], "dies": ["remove"], "disabled": ["disable"], "enabled": ["disable", "enable"], "moved": ["move"],
                 "set": ["set"]}.get(focus, [])
        wanted = meant + [self.draws.choice(actions) for _ in range(self.draws.choice((0, 1, 2, 3, 5)))]
        together = ["move", "add", self.draws.choice(("remove", "move", "add")), "add"] if self.chance(0.3) else []
        wanted += together  # most of them happen in one tick, some at one place
        moment = self.time(3)
        entries = []
        for number, action in enumerate(wanted):
            make = getattr(self, f"_at_{action}", None)
            entry = make(number < len(meant)) if make else {action: self.whom()}
            if entry:
                time = self.time(1, self.ticks // 2) if action == "disable" else self.time(3)
                if number >= len(wanted) - len(together) and self.chance(0.7):
                    time = moment
                entries.append({"time_s": time, **entry})
        for entry in entries:  # enable in the second half, after disable
            if "enable" in entry:
                entry["time_s"] = self.time(self.ticks // 2)
        self.draws.shuffle(entries)
        self.world["at"] = entries

    def _at_add(self, meant):
        populations = [each["name"] for each in self.world["populations"] if each.get("reserve")]
        if not populations:
            return None
        name = "f" if meant or "f" in populations and self.chance(0.5) else self.draws.choice(populations)
        inner = rounded(self.inner)
        if self.places and self.chance(0.5):
            return {"add": {"population": name, "count": 1, "pose": self.draws.choice(self.places)}}
        return {"add": {"population": name, "count": self.draws.randint(1, 3), "region_m": [[-inner, -inner], [inner, inner]]}}

    def _at_enable(self, meant):
        return {"enable": {"type": "focus"} if meant else self.whom(many=False)}

    def _at_move(self, _):
        count = self.world["populations"][0]["count"]
        pose = {"x_m": rounded(self.draws.uniform(-self.inner, self.inner)), "y_m": rounded(self.draws.uniform(-self.inner, self.inner)),
                "heading_deg": self.draws.choice((0, 77, -135))}
        self.places.append(pose)
        return {"move": {"model": f"f{self.draws.randrange(count)}", "pose": pose}} if count else None

    def _at_set(self, meant):
        types = self.world["types"]
        name = "focus" if meant or self.chance(0.6) else self.draws.choice(list(types))
        one = types[name]
        choices = []
        for family, key in (("sensor", "sensors"), ("device", "devices"), ("controller", "controllers")):
            choices += [(family, part) for part in one.get(key, ())]
        if "drive" in one:
            choices.append(("drive", one["drive"]))
        choices = [(family, part) for family, part in choices if settable(self.kinds.of(family)[part["kind"]])]
        of_focus = [(family, part) for family, part in choices if (family, part["kind"]) == self.focus[:2]]
        if not choices:
            return None
        family, part = self.draws.choice(of_focus if meant and of_focus else choices)
        kind = self.kinds.of(family)[part["kind"]]
        drawn = self.parameters(kind, often=1)
        allowed = [key for key in settable(kind) if key in drawn]
        if not allowed and kind.name not in SET_OF:
            return None
        changed = {key: drawn[key] for key in self.draws.sample(allowed, min(len(allowed), self.draws.randint(1, 3)))}
        if family == "controller" and kind.name in SET_OF:
            changed = self.draws.choice(SET_OF[kind.name])
        if family == "device" and kind.name == "spawner":
            changed = {"every_s": rounded(self.tick_s * self.draws.randint(1, 9))}
        if family == "device" and kind.name == "power_pack" and "capacity_J" in changed:
            changed["capacity_J"] = rounded(part.get("capacity_J", 100) * self.draws.choice((0.5, 2)))
        if family == "controller" and kind.name == "operate":
            changed = {"orders": self._orders(_operable(one))}
        if one.get("drive", {}).get("kind") != "omni":
            for goal in changed.get("goals", ()):
                goal.pop("speed_mps", None)
        which = {"kind": part["kind"]} if family == "controller" else {} if family == "drive" else {"name": part["name"]}
        key = "device" if family == "sensor" else family
        return {"set": {"type": name, key: {**which, **changed}}}

    def _faults(self):
        for _ in range(self.draws.choice((0, 0, 1, 2))):
            name = self.draws.choice(list(self.kinds.of("fault")))
            kind = self.kinds.of("fault")[name]
            one = self.world["types"]["focus"]
            if name == "slow_wheels" and "drive" not in one or name == "dead_sensors" and not one.get("sensors"):
                continue
            parameters = self.parameters(kind)
            if name == "dead_sensors":
                parameters = {"sensors": one["sensors"][0]["name"]} if self.chance(0.5) else {}
            if name == "drop_out":
                parameters["rate_per_s"] = rounded(self.draws.uniform(0.05, 1) / (self.tick_s * self.ticks / 2))
                parameters["for_s"] = rounded(self.tick_s * self.draws.randint(0, 10))
            self.world["faults"].append({"population": "f", **({"share": 0.6} if self.chance(0.5) else {}),
                                         "from_s": self.time(1, self.ticks // 2), name: parameters})

    def _measures(self):
        for name in self.draws.sample(list(self.kinds.of("measure")), 3):
            one = {"kind": name, **self.parameters(self.kinds.of("measure")[name])}
            if name == "deaths":
                one["type"] = "focus"
            elif name in ("state_mean", "state_variance"):
                one.update(component="pose", field="x")
                one.pop("column", None)
            elif name == "rank_errors":
                one["center_m"] = [0, 0]
            elif name in ("clusters", "largest_cluster") and not any(made.get("pushable") for made in self.world["types"].values()):
                one["bodies"] = "robots"
            elif name == "coverage" and "cell_m" in one:
                one["cell_m"] = rounded(self.draws.uniform(0.3, 1))
            if name not in ("clusters", "largest_cluster", "deaths") and "drive" in self.world["types"]["focus"] and self.chance(0.3):
                one["of"] = "focus"
            one["name"] = f"m{len(self.world['measures'])}"
            self.world["measures"].append(one)


def _operable(one):
    """Returns the devices of a type that an `operate` controller can operate: grippers and actuators."""
    return [device for device in one["devices"] if device["kind"] in ("gripper", "actuator")]


def make_world(kinds, seed, index, pairs=None):
    """Returns (world, ticks, focus) of the random world with this seed and index: the JSON document, the length of its run,
    and its focus, (family, kind, event). pairs: the result of pairs_of(kinds), if it is known."""
    focus = focus_of(pairs or pairs_of(kinds), seed, index)
    made = Generator(kinds, seed, index, focus)
    return made.world, made.ticks, focus


def plan_image():
    """Returns the bytes of the image PLAN that worlds use as a floor plan, in PGM format: white except for its edge and two
    short walls."""
    size = 64
    pixels = bytearray([255] * size * size)
    for i in range(size):
        for at in (i, (size - 1) * size + i, i * size, i * size + size - 1):
            pixels[at] = 0
    for i in range(3):
        pixels[32 * size + 4 + i] = pixels[(60 - i) * size + 32] = 0
    return b"P5 %d %d 255\n" % (size, size) + bytes(pixels)
