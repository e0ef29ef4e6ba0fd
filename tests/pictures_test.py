#!/usr/bin/env python3
"""Checks that the pictures of the documentation are up to date. The text of each picture contains its world, seed and time,
and the hash of the state that it shows; the test runs the world and compares the hash.

    pictures_test.py TROUPE          pictures of up to 200 simulated seconds
    pictures_test.py TROUPE --all    all pictures; takes minutes

Exit codes: 0 all pictures are up to date, 1 some are not.
"""

import json
import pathlib
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LONGEST_S = 200
# Pictures of worlds that are listings on a page; tests/docs_test.py runs these worlds.
OF_PAGES = {"tutorial.png"}


def texts_of(png):
    """Returns the keywords and texts of the tEXt chunks of a PNG (PNG specification, 11.3.4.3)."""
    data = png.read_bytes()
    texts, at = {}, 8
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"tEXt":
            key, text = data[at + 8:at + 8 + length].decode("latin-1").split("\0", 1)
            texts[key] = text
        at += 12 + length
    return texts


def main():
    troupe, longest_s = sys.argv[1], float("inf") if "--all" in sys.argv[2:] else LONGEST_S
    pictures = sorted((ROOT / "docs" / "images").rglob("*.png"))
    hashes, faults, compared = {}, [], 0
    for picture in pictures:
        texts, name = texts_of(picture), picture.relative_to(ROOT)
        if "state_hash" not in texts or picture.name in OF_PAGES:
            continue
        world, seed, time_s = texts["world"], texts["seed"], float(texts["time_s"])
        if not (world.startswith("worlds/") and (ROOT / world).exists()):
            faults.append(f"{name}: is of {world}, which is none of ours")
            continue
        if time_s > longest_s:
            continue
        if (world, seed, time_s) not in hashes:
            command = [troupe, "run", world, "--for", f"{time_s:.10g}", "--seed", seed, "--quiet", "--json"]
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
            hashes[world, seed, time_s] = json.loads(done.stdout)["state_hash"] if done.returncode == 0 else done.stderr.strip()
        compared += 1
        if hashes[world, seed, time_s] != texts["state_hash"]:
            faults.append(f"{name}: shows {texts['state_hash']}, but {world} is {hashes[world, seed, time_s]} after {time_s:g} s")
    print(*faults, sep="\n")
    print(f"{compared} of {len(pictures)} pictures compared, {len(faults)} differ")
    return 1 if faults or compared == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
