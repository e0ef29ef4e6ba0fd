"""Counts the kinds of parts in random worlds, and the events (born, dies, carried, ...) of bodies with a part of each kind."""

import re
from collections import Counter

from .random_worlds import PART_FAMILIES, pairs_of
from .sessions import ACTS

# Events of `troupe run --events` that have another name in the pairs of kind and event.
EVENTS = {"birth": "born", "death": "dies", "fails": "disabled", "recovers": "enabled"}


def parts_of(one):
    """Returns (family, kind) of the drive, the sensors, devices and controllers of a type. one: the type, a dict as in a JSON
    world."""
    parts = [("drive", one["drive"]["kind"])] if "drive" in one else []
    for family, key in (("sensor", "sensors"), ("device", "devices"), ("controller", "controllers")):
        parts += [(family, part["kind"]) for part in one.get(key, ())]
    return parts


class Coverage:
    def __init__(self, kinds):
        self.kinds = kinds
        self.wanted_pairs = pairs_of(kinds)
        self.kind_counts, self.pairs, self.rules, self.actions, self.engines, self.acts = (Counter() for _ in range(6))

    def _type_of(self, world, name):
        for model in world.get("models", ()):
            if model["name"] == name:
                return model["type"]
        stem = re.sub(r"\d+$", "", name)
        return next((each["type"] for each in world.get("populations", ()) if each["name"] == stem), None)

    def add(self, world, told):
        """Counts what occurs in a world and in its run. told: the report of library_worker.py about the run."""
        types = world["types"]
        populated = {each["type"] for each in world.get("populations", ())} | {each["type"] for each in world.get("models", ())}
        for name in populated:
            self.kind_counts.update(parts_of(types[name]))
        self.kind_counts.update(("measure", each["kind"]) for each in world.get("measures", ()))
        for fault in world.get("faults", ()):
            self.kind_counts.update(("fault", key) for key in fault if key in self.kinds.of("fault"))
        self.rules.update(each["place"]["rule"] for each in world.get("populations", ()))
        self.engines[world.get("ranging", "exact")] += 1
        self.acts.update(told.get("acts", ()))
        end = told["ticks"] * world["tick_s"]
        seen = set()

        def happened(event, type_name):
            if type_name in types:
                seen.update((*part, event) for part in parts_of(types[type_name]))

        for event, robot, other in told["events"]:
            if event in EVENTS:
                happened(EVENTS[event], self._type_of(world, robot))
            elif event == "grip" and other:
                happened("carried", self._type_of(world, other))
        for name in told["resumed"]:
            happened("resumed", self._type_of(world, name))
        for entry in world.get("at", ()):
            if entry["time_s"] >= end:
                continue
            action = next(key for key in entry if key != "time_s")
            self.actions[action] += 1
            if action == "move":
                happened("moved", self._type_of(world, entry["move"]["model"]))
            if action == "set":
                one = types.get(entry["set"]["type"], {})
                for family, kind in self._what_is_set(entry["set"], one):
                    seen.add((family, kind, "set"))
        self.pairs.update(seen)

    def _what_is_set(self, setting, one):
        if "drive" in setting:
            return [("drive", one["drive"]["kind"])]
        if "controller" in setting:
            return [("controller", setting["controller"]["kind"])]
        name = setting["device"]["name"]
        return [(family, part["kind"]) for family, key in (("sensor", "sensors"), ("device", "devices"))
                for part in one.get(key, ()) if part["name"] == name]

    def missing(self):
        """Returns the names of the kinds, placement rules, interventions, acts of sessions, ranging engines, and pairs of kind
        and event that have not occurred."""
        names = [f"{kind.family} {kind.name}" for kind in self.kinds.all() if not self.kind_counts[kind.family, kind.name]]
        names += [f"placement rule {rule}" for rule in self.kinds.rules if not self.rules[rule]]
        names += [f"intervention {action}" for action in self.kinds.actions if not self.actions[action]]
        names += [f"act {act}" for act in ACTS if not self.acts[act]]
        names += [f"ranging {engine}" for engine in self.kinds.ranging if not self.engines[engine]]
        return names + [f"{family} {kind}: {event}" for family, kind, event in self.wanted_pairs
                        if not self.pairs[family, kind, event]]

    def summary(self):
        kinds = [kind for kind in self.kinds.all() if self.kind_counts[kind.family, kind.name]]
        return (f"{len(kinds)} of {len(self.kinds.all())} kinds, "
                f"{sum(self.pairs[pair] > 0 for pair in self.wanted_pairs)} of {len(self.wanted_pairs)} pairs of a kind "
                f"({', '.join(PART_FAMILIES)}) and an event")
