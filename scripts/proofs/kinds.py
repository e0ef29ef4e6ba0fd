"""All kinds of parts of a world (drives, sensors, devices, controllers, ...), each with the JSON Schema of its parameters, as
`troupe describe --schema` prints them."""

import json
import subprocess

from .runs import Fault

FAMILIES = ("drive", "sensor", "device", "controller", "measure", "fault")
# Keys of every sensor, device or controller in addition to its own parameters.
COMMON = {"kind", "name", "pose", "active", "joint", "on", "color", "obstacle", "ranger_return", "fiducial_return",
          "fiducial_key", "gripper_return", "blob_return", "pushable", "blocks", "of", "ring", "update_period_s",
          "update_period_ms"}


class Kind:
    """A kind: its family (one of FAMILIES), its name, `parameters` (a dict from JSON keys to schemas; a quantity that has keys
    in several units is listed only with the first one), and `required`, the keys that must be given."""

    def __init__(self, family, name, schema):
        self.family, self.name = family, name
        self.required = [key for key in schema.get("required", []) if key not in COMMON]
        other_units = set()
        for group in schema.get("allOf", []):
            alternatives = [one["required"][0] for one in group.get("oneOf", []) if len(one.get("required", ())) == 1]
            other_units.update(alternatives[1:])
            if len(alternatives) == len(group.get("oneOf", [])) and alternatives:
                self.required.append(alternatives[0])  # exactly one of the alternatives is required
        parameters = {key: value for key, value in schema.get("properties", {}).items()
                      if key not in COMMON and key not in other_units}
        # period_s is the update period, except in a device with update_period_s, where it is a parameter.
        own_period = "update_period_s" in schema.get("properties", {})
        if family not in ("measure", "fault") and not own_period:
            parameters.pop("period_s", None)
        self.parameters = parameters

    def __repr__(self):
        return f"{self.family} {self.name}"


class Kinds:
    """All kinds, by family and name, and the names of the placement rules, interventions and ranging engines. schema: the JSON
    Schema of worlds, from which they are read."""

    def __init__(self, schema):
        self.schema = schema
        definitions = schema["definitions"]
        self._families = {family: {} for family in FAMILIES}
        for family in ("drive", "sensor", "device", "controller"):
            for one in definitions[family]["anyOf"]:
                self._add(family, one)
        for one in schema["properties"]["measures"]["items"]["anyOf"]:
            self._add("measure", one)
        faults = schema["properties"]["faults"]["items"]["properties"]
        whom = set(definitions["group"]["properties"]) | {"from_s", "from_ms"}
        for name, one in faults.items():
            if name not in whom:
                self._families["fault"][name] = Kind("fault", name, one)
        places = schema["properties"]["populations"]["items"]["properties"]["place"]["anyOf"]
        self.rules = [one["properties"]["rule"]["const"] for one in places]
        actions = schema["properties"]["at"]["items"]["properties"]
        self.actions = [name for name in actions if not name.startswith("time_")]
        self.ranging = schema["properties"]["ranging"]["enum"]
        for family, kinds in self._families.items():
            if not kinds:
                raise Fault(f"the schema of worlds lists no kind of the family {family}")

    def _add(self, family, schema):
        name = schema.get("properties", {}).get("kind", {}).get("const")
        if name is not None:  # None: the placeholder for plug-ins
            self._families[family][name] = Kind(family, name, schema)

    def of(self, family):
        return self._families[family]

    def all(self):
        return [kind for kinds in self._families.values() for kind in kinds.values()]

    def resolve(self, schema):
        """Returns the schema to which the `$ref` of a schema refers, or the schema itself if it has none."""
        reference = schema.get("$ref")
        return self.schema["definitions"][reference.rsplit("/", 1)[1]] if reference else schema


def kinds_of(program):
    """Returns the Kinds of a program, from `troupe describe --schema`. Raises Fault if the program fails."""
    done = subprocess.run([str(program), "describe", "--schema"], capture_output=True, text=True)
    if done.returncode != 0:
        raise Fault(f"{program} describe --schema failed: {done.stderr.strip()}")
    return Kinds(json.loads(done.stdout))
