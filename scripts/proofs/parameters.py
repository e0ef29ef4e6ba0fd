"""Random parameters of kinds. Most parameters are drawn according to their JSON Schema. Parameters that depend on one another
or on the world are drawn by functions for single kinds (Parameters._FAMILY_KIND)."""

import math

# Parameters that determine the layout of the state; `set` may not change them.
SHAPE = {"transducers", "bumpers", "width", "height", "payload", "directions", "image_width", "image_height", "points_m",
         "localization", "localization_origin_m", "localization_origin_heading_rad", "odom_error", "odom_heading", "most",
         "paddle_size", "size_m", "type", "drive", "source", "sink", "map", "task", "task2", "task3", "task4", "task5", "task6",
         "task7", "task8", "charger", "puck", "stored_J", "yellow", "paddles", "lift", "start_position", "start_x_mps",
         "start_y_mps", "start_turn_radps", "clearances_m", "channel", "shows", "unused", "pushes", "turns_when_blocked", "crashes", "most_heard", "most_targets",
         "most_blobs", "when_empty", "min_position", "max_position", "axis"}
SHAPE_OF = {"ranger": {"intensity"}, "dynamic": {"count", "reach_m"}}

# Further parameters that `set` may change, for controllers whose parameters name models of the world.
SET_OF = {"fasr2": [{"task2": ""}, {"task": "green"}], "collector": [{"sink": "sink1"}, {"charger": 9}, {"puck": 2}],
          "fasr": [{"source": "sink", "sink": "source"}]}
COLORS = ("red", "SteelBlue", "gold", "LimeGreen", "black", "white", "gray40")


def settable(kind):
    """Returns the JSON keys of the parameters of a kind that the intervention `set` may change during a run, sorted."""
    return sorted({key for one in SET_OF.get(kind.name, ()) for key in one}
                  | kind.parameters.keys() - SHAPE - SHAPE_OF.get(kind.name, set()))


def rounded(value):
    return float(f"{value:.4g}")


class Values:
    """Random values that match a JSON Schema. kinds: the Kinds whose definitions schemas refer to; draws: the random.Random
    from which values are drawn."""

    def __init__(self, kinds, draws):
        self._kinds, self._draws = kinds, draws

    def of(self, schema, key=""):
        draws = self._draws
        if "$ref" in schema:
            if schema["$ref"].endswith("/pose"):
                return self.small_pose()
            if schema["$ref"].endswith("/color"):
                return draws.choice(COLORS)
            schema = self._kinds.resolve(schema)
        if "const" in schema:
            return schema["const"]
        if "enum" in schema:
            return draws.choice(schema["enum"])
        if "anyOf" in schema:
            return self.of(draws.choice(schema["anyOf"]), key)
        kind = schema.get("type")
        if kind == "boolean":
            return draws.random() < 0.5
        if kind == "integer":
            return self._integer(schema)
        if kind == "number":
            return self._number(schema)
        if kind == "array":
            least = schema.get("minItems", 0)
            count = draws.randint(least, max(least, min(schema.get("maxItems", 3), 3)))
            return [self.of(schema["items"]) for _ in range(count)]
        if kind == "object":
            required = set(schema.get("required", ()))
            return {name: self.of(value, name) for name, value in schema.get("properties", {}).items() if name in required}
        return schema.get("default", "")

    def small_pose(self):
        draws = self._draws
        return {"x_m": rounded(draws.uniform(-0.1, 0.1)), "y_m": rounded(draws.uniform(-0.1, 0.1)),
                "z_m": rounded(draws.uniform(0.05, 0.3)), "heading_deg": draws.choice((0, 0, 30, -90, 180))}

    def _bounds(self, schema):
        low = schema.get("minimum", schema.get("exclusiveMinimum", -math.inf))
        return low, schema.get("maximum", schema.get("exclusiveMaximum", math.inf))

    def _integer(self, schema):
        low, high = self._bounds(schema)
        default = schema.get("default", 1)
        return int(self._draws.randint(max(low, 0), max(low, min(high, max(3, 2 * default)))))

    def _number(self, schema):
        """Returns a random number, mostly near the default; sometimes a bound of the schema, if the bound is not far away and
        is allowed."""
        low, high = self._bounds(schema)
        default = schema.get("default", 0.5)
        default = default if isinstance(default, (int, float)) else 0.5
        low_ends = [low] if "minimum" in schema and abs(low) <= 1000 else []
        high_ends = [high] if "maximum" in schema and abs(high) <= 10 else []
        near = default * self._draws.uniform(0.3, 1.7) if default else self._draws.uniform(0.01, 0.5)
        value = self._draws.choice([near] * 6 + low_ends + high_ends)
        value = min(max(value, low), high)
        if value == low and "minimum" not in schema:
            value = low + min(0.1, (high - low) / 2)
        return min(max(rounded(value), low), high)


class Parameters:
    """Draws the parameters of drives, sensors, devices, controllers, measures and faults. The generator of worlds derives from
    this class and provides `draws`, `values`, `kinds`, `world`, `tick_s` and `reserves` (populations with bodies that can be
    born)."""

    def chance(self, p):
        return self.draws.random() < p

    def parameters(self, kind, given=None, often=0.35):
        """Returns random parameters of a kind, {JSON key: value}: the required parameters, each other one with the probability
        `often`, and the values in `given`."""
        chosen = {key: self.values.of(schema, key) for key, schema in kind.parameters.items()
                  if key in kind.required or self.chance(often)}
        chosen.update(given or {})
        return self._mended(kind, chosen, given or {})

    def _mended(self, kind, chosen, given):
        """Adjusts parameters to rules that schemas cannot express: related limits, names in this world, and sizes that keep
        worlds small. Returns the adjusted `chosen`."""
        draws = self.draws
        for key in list(chosen):
            if "_min_" in key or key.startswith("turn_min"):
                chosen[key] = -abs(chosen[key]) - 0.1
            elif "_max_" in key or key.startswith("turn_max"):
                chosen[key] = abs(chosen[key]) + 0.1
        for key in ("start_x_mps", "start_y_mps", "start_turn_radps"):
            if key in chosen:
                chosen[key] = rounded(draws.uniform(-0.3, 0.3))
        if "localization_origin_m" in chosen:
            chosen["localization_origin_m"] = draws.choice(([], [0, 0], [1, -0.5]))
        if "localization_origin_heading_rad" in chosen:
            chosen.setdefault("localization_origin_m", [0.5, 0.5])
        if "odom_error" in chosen:
            chosen["odom_error"] = draws.choice(([], [], [0.01, -0.02, 0.05]))
        if kind.family == "drive" and "localization" not in chosen:
            chosen["localization"] = draws.choice(("odom", "odom", "gps"))
        if "wheelbase_m" in chosen:
            chosen["wheelbase_m"] = rounded(draws.uniform(0.1, 0.6))
        special = getattr(self, f"_{kind.family}_{kind.name}", None)
        if special:
            special(chosen, given)
        return chosen

    def _sensor_ranger(self, chosen, given):
        if "transducers" not in given:
            fans = []
            for _ in range(self.draws.choice((1, 1, 2, 3))):
                fan = {"samples": self.draws.choice((1, 3, 9)), "range_max_m": rounded(self.draws.uniform(0.5, 4))}
                schema = self.kinds.of("sensor")["ranger"].parameters["transducers"]["items"]["properties"]
                for key in ("fov_rad", "noise_stddev_m", "noise_proportional", "noise_angular_rad", "apply_range_min",
                            "range_min_m", "beam_width_rad", "noise_relative", "pose"):
                    if key in schema and self.chance(0.3):
                        fan[key] = self.values.of(schema[key], key)
                if "range_min_m" in fan:
                    fan["range_min_m"] = rounded(self.draws.uniform(0, 0.3))
                if fan["samples"] == 1:
                    fan.pop("fov_rad", None)
                elif "fov_rad" in fan:
                    fan["fov_rad"] = rounded(self.draws.uniform(0.2, 6))
                for key in ("noise_angular_rad", "beam_width_rad"):
                    if key in fan:
                        fan[key] = rounded(self.draws.uniform(0, 0.3))
                fans.append(fan)
            chosen["transducers"] = fans

    def _sensor_fiducial(self, chosen, _):
        chosen["most_targets"] = self.draws.randint(1, 6)
        if "key" in chosen:
            chosen["key"] = self.draws.choice((0, 0, 3))
        if "range_min_m" in chosen:
            chosen["range_min_m"] = rounded(self.draws.uniform(0, 0.5))

    def _sensor_blobfinder(self, chosen, _):
        chosen.update(image_width=self.draws.randint(1, 24), image_height=self.draws.randint(1, 24),
                      most_blobs=self.draws.randint(1, 5))

    def _sensor_bumper(self, chosen, _):
        chosen["bumpers"] = [{"pose": {"x_m": 0.12, "z_m": 0.1}, "length_m": 0.2},
                             {"pose": {"x_m": -0.12, "z_m": 0.1, "heading_deg": 180}, "length_m": 0.1}][:self.draws.randint(1, 2)]
        if "thickness_m" in chosen:
            chosen["thickness_m"] = rounded(self.draws.uniform(0, 0.1))

    def _sensor_camera(self, chosen, _):
        chosen.update(width=self.draws.randint(1, 8), height=self.draws.randint(1, 8))
        chosen.pop("range_near_m", None)
        if "range_far_m" in chosen:
            chosen["range_far_m"] = rounded(self.draws.uniform(1, 6))

    def _sensor_radio(self, chosen, given):
        chosen["payload"] = given.get("payload", self.draws.randint(4, 16))
        chosen["range_m"] = rounded(self.draws.uniform(0.5, 6))
        chosen["most_heard"] = self.draws.randint(1, 6)
        if "drop_rate" in chosen:
            chosen["drop_rate"] = self.draws.choice((0, 0.1, 0.5))
        for key in ("power_dBm", "sensitivity_dBm", "frequency_GHz", "channel"):
            chosen.pop(key, None)
        if self.chance(0.2):
            chosen["channel"] = "b"

    def _sensor_ground(self, chosen, _):
        if "points_m" in chosen:
            chosen["points_m"] = self.draws.choice(([0, 0], [0.1, 0, -0.1, 0.05]))

    def _sensor_light_sensor(self, chosen, given):
        chosen["directions"] = given.get("directions", self.draws.randint(1, 9))

    def _device_power_pack(self, chosen, _):
        chosen.pop("stored_J", None)
        chosen["capacity_J"] = self.draws.choice((20, 200, 5000, 5000))
        if self.chance(0.5):
            chosen["stored_J"] = rounded(chosen["capacity_J"] * self.draws.uniform(0.1, 1))
        if "mass_kg" in chosen:
            chosen["mass_kg"] = rounded(self.draws.uniform(0, 2))
        if "draw_W" in chosen:
            chosen["draw_W"] = rounded(self.draws.uniform(0, 3))

    def _device_power_contact(self, chosen, _):
        for key in ("give_W", "take_W"):
            if self.chance(0.7):
                chosen[key] = rounded(self.draws.uniform(0, 80))

    def _device_flags(self, chosen, _):
        chosen["most"] = self.draws.randint(2, 12)
        if "yellow" in chosen:
            chosen["yellow"] = self.draws.randint(0, chosen["most"])

    def _device_actuator(self, chosen, _):
        chosen.update(min_position=0, max_position=rounded(self.draws.uniform(0.05, 0.3)), size_m=[0.1, 0.05, 0.05],
                      start_position=0)
        chosen["axis"] = self.draws.choice(([1, 0, 0], [0, 0, 1], [0, 0, 0]))

    def _device_gripper(self, chosen, _):
        chosen.pop("paddle_size", None)
        chosen["size_m"] = [0.2, 0.3, 0.2]
        chosen["pose"] = {"x_m": 0.3}

    def _device_wheels(self, chosen, _):
        chosen["size_m"] = [0.1, 0.1, 0.1]
        chosen["pose"] = {"z_m": 0.5}

    def _device_spawner(self, chosen, _):
        if self.reserves:
            chosen["population"] = self.draws.choice(self.reserves)
            chosen["every_s"] = rounded(self.tick_s * self.draws.randint(1, 12))
            chosen["within_m"] = self.draws.choice((0, 1.0, 2.5))
        else:
            chosen.clear()
        if "per_flags" in chosen:
            chosen["per_flags"] = self.draws.randint(0, 2)

    def _device_remover(self, chosen, _):
        chosen["radius_m"] = rounded(self.draws.uniform(0.1, 0.6))
        if self.chance(0.3):
            mortal = [name for name in self.world["types"] if name != "wall"]  # walls are static
            chosen["of"] = self.draws.choice(mortal or [""])

    def _controller_script(self, chosen, _):
        chosen["law"] = self.draws.choice(("timed", "timed", "timed", "wave", "line"))
        if chosen["law"] != "timed":
            chosen.pop("legs", None)
            return
        chosen["legs"] = []
        until = 0
        for _ in range(self.draws.randint(1, 4)):
            until = rounded(until + self.tick_s * self.draws.randint(2, 40))
            chosen["legs"].append({"until_s": until, "forward_mps": rounded(self.draws.uniform(-0.2, 0.6)),
                                   "turn_radps": rounded(self.draws.uniform(-1, 1))})

    def _controller_waypoints(self, chosen, _):
        chosen["goals"] = [{"x_m": rounded(self.draws.uniform(-2, 2)), "y_m": rounded(self.draws.uniform(-2, 2)),
                            **({"wait_s": self.tick_s} if self.chance(0.3) else {}),
                            **({"speed_mps": 0.3} if self.chance(0.3) else {})} for _ in range(self.draws.randint(1, 4))]
        if "near_m" in chosen:
            chosen["near_m"] = rounded(self.draws.uniform(0.03, 0.4))

    def _controller_source(self, chosen, _):
        chosen["capacity"] = self.draws.randint(1, 2)

    def _controller_fasr(self, chosen, _):
        chosen.clear()

    def _controller_fasr2(self, chosen, _):
        chosen.clear()
        chosen.update(task="red", task2="green")

    def _controller_dynamic(self, chosen, _):
        chosen.update(count=self.draws.randint(1, 4), reach_m=0.1)

    def _controller_operate(self, chosen, _):
        chosen.pop("plan", None)
        chosen["orders"] = []

    def _controller_collector(self, chosen, _):
        chosen.clear()

    def _controller_brazil_nut(self, chosen, _):
        chosen["radius_m"] = rounded(self.draws.uniform(0.1, 0.5))

    def _controller_expand_pioneer(self, chosen, _):
        chosen.pop("clearances_m", None)

    _controller_expand_swarm = _controller_expand = _controller_expand_pioneer

    def _controller_chain(self, chosen, _):
        chosen["role"] = self.draws.choice(("robot", "robot", "nest", "prey"))
