#!/usr/bin/env python3
"""Compares docs/world.schema.json with the reader of worlds.

    world_schema_test.py TROUPE [SPOILT]    SPOILT: number of faults of each sort in each world (default: 6)

The schema must equal the output of `troupe describe --schema`. All JSON worlds of the source tree must satisfy it, and so
must the results of `troupe convert` for the worlds in Stage's syntax. If a fault is inserted into a world (an unknown
key, a value of another type, a missing required key), both the schema and the program must reject the world.
"""

import copy
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

from proofs.scenes import shipped  # noqa: E402

SKIPPED = 77  # ctest's SKIP_RETURN_CODE

try:
    import jsonschema
except ImportError:
    system = "/usr/bin/python3"  # has Debian's jsonschema, even if another Python is first on the path
    if os.path.exists(system) and os.environ.get("TROUPE_SYSTEM_PYTHON") is None:
        os.execve(system, [system, *sys.argv], {**os.environ, "TROUPE_SYSTEM_PYTHON": "1"})
    print("SKIPPED: no jsonschema (scripts/setup --checks installs python3-jsonschema): the schema of worlds was "
          "not compared with their reader")
    sys.exit(SKIPPED)

TROUPE = pathlib.Path(sys.argv[1]).resolve()
SPOILT = int(sys.argv[2]) if len(sys.argv) > 2 else 6

faults = []


def troupe(*words):
    return subprocess.run([TROUPE, *map(str, words)], capture_output=True, text=True)


def pointer(path):
    return "".join(f"/{token}" for token in path)


def findings(validator, world):
    return [f"{pointer(fault.absolute_path)}: {fault.message[:200]}" for fault in validator.iter_errors(world)]


def check_fits(validator, name, world):
    faults.extend(f"{name} does not fit the schema: {fault}" for fault in findings(validator, world))


def objects_of(value, path=()):
    """Yields (path, object) for every object with a fixed set of keys."""
    if isinstance(value, dict):
        if path != ("types",):
            yield path, value
        for key, member in value.items():
            if path[-1:] == ("set",):
                continue  # parameters of a device or controller of a type, whose kind the schema cannot know
            yield from objects_of(member, (*path, key))
    elif isinstance(value, list):
        for i, member in enumerate(value):
            yield from objects_of(member, (*path, i))


def at(world, path):
    for token in path:
        world = world[token]
    return world


def spoilt(world, draws):
    """Copies of a world with one fault each: (what it is, the copy)."""
    places = list(objects_of(world))
    for path, _ in draws.sample(places, min(SPOILT, len(places))):
        copied = copy.deepcopy(world)
        at(copied, path)["nonsense"] = 1
        yield f"{pointer(path)}/nonsense", copied
    for path, found in draws.sample(places, min(SPOILT, len(places))):
        key = draws.choice(sorted(found)) if found else None
        if key is None or key == "$schema":
            continue
        copied = copy.deepcopy(world)
        at(copied, path)[key] = [{"nonsense": None}]  # a value that no key accepts
        yield f"{pointer(path)}/{key} of another type", copied
    for path, key in (((), "troupe"), (("populations", 0), "type"), (("populations", 0), "count"),
                      (("models", 0), "name")):
        try:
            copied = copy.deepcopy(world)
            del at(copied, path)[key]
        except (KeyError, IndexError):
            continue
        yield f"{pointer(path)} without {key}", copied


def check_spoilt(validator, file, world, draws, folder):
    """folder: contains the files to which the world refers."""
    for what, copied in spoilt(world, draws):
        if not findings(validator, copied):
            faults.append(f"the schema takes {file.name} with {what}")
        beside = folder / "spoilt.json"
        beside.write_text(json.dumps(copied))
        done = troupe("convert", beside, folder / "never-written.world")
        if done.returncode != 2:
            faults.append(f"troupe takes {file.name} with {what}: {done.stderr}")


def main():
    checked_in = (ROOT / "docs" / "world.schema.json").read_text()
    printed = troupe("describe", "--schema").stdout
    if checked_in != printed:
        faults.append("docs/world.schema.json is not what `troupe describe --schema` prints; write it there")
    schema = json.loads(printed)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)

    included = {"$schema": "world.schema.json", "include": [], "types": {"box": {"size_m": [1, 1, 1]}}}
    check_fits(validator, "an included file without \"troupe\"", included)
    if not findings(validator, {**included, "models": []}):
        faults.append("the schema takes a world without \"troupe\"")
    draws = random.Random(1)
    worlds = [ROOT / "worlds" / name for name in shipped() if name.endswith(".json")] + [
        ROOT / "apps/examples/plugin/room.json", ROOT / "apps/examples/sensor_plugin/room.json"]
    converted = 0
    with tempfile.TemporaryDirectory(prefix="troupe-schema-") as name:
        folder = pathlib.Path(name) / "worlds"
        shutil.copytree(ROOT / "worlds", folder)
        for file in worlds:
            world = json.loads(file.read_text())
            check_fits(validator, file.name, world)
            if file.parent.name == "worlds":  # other worlds may have kinds of plug-ins, which the schema does not contain
                check_spoilt(validator, file, world, draws, folder)
        for file in sorted((ROOT / "worlds").glob("*.world")):
            to = pathlib.Path(name) / f"{file.stem}.json"
            done = troupe("convert", file, to)
            if done.returncode == 0:
                converted += 1
                check_fits(validator, f"{file.name}, converted,", json.loads(to.read_text()))
            else:
                faults.append(f"{file.name} cannot be converted: {done.stderr}")
    if converted == 0:
        faults.append("no world was converted")
    print("\n".join(faults) or f"{len(worlds)} worlds and {converted} converted ones fit the schema")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
