#!/usr/bin/env python3
"""Tests docs_test.py: it must report the fault of each page in a list of faulty pages.

    docs_faults_test.py TROUPE
"""

import pathlib
import shutil
import sys
import tempfile

import docs_test

TROUPE = pathlib.Path(sys.argv[1]).resolve()

# (text of a page, expected text of the report; None: the page has no fault)
PAGES = [
    ("    troupe describe ranger\n", None),
    ("    $ troupe describe lightindicator\n    device lightindicator: a light that controllers switch\n    ...\n", None),
    ("    $ troupe describe lightindicator\n    device lightindicator: a light that no controller switches\n", "does not print the line"),
    ("    troupe describe rangre\n", "ended with 2"),
    ("    $ troupe describe rangre\n    troupe describe: error: \"rangre\" is neither a kind nor a key of JSON worlds (did you mean \"ranger\"?); ...\n", None),
    ("    $ troupe describe ranger\n    error: \n", "ended with 0"),
    ("    troupe run worlds/minimal.world --for 1 --frobnicate\n", "ended with 2"),
    ("    mkdir other && cd other\n    troupe run worlds/minimal.world --for 1\n", "ended with 2"),
    ("    mkdir other && cd other\n    troupe run ../worlds/minimal.world --for 1 --hash-log a.log\n\n"
     "writes\n\n    # world: ...\n", None),
    ("    troupe run worlds/minimal.world --for 1 --hash-log a.log\n\nwrites\n\n    11 0123456789abcdef ...\n", "has these lines"),
    ("    $ troupe run worlds/minimal.world --for 1 | grep -E 'ticks|wall'\n      ticks 10 of 0.1 s\n      wall  7 s, after 8 s of loading\n",
     None),
    ("    $ troupe run worlds/minimal.world --for 1 | grep -E 'ticks|wall'\n      ticks 11 of 0.1 s\n      ...\n",
     "does not print the line"),
    ("    scripts/quickstart\n", "none of its commands is run"),
    ("A text.\n\n    that no command prints\n", "has these lines"),
    ("Save this as `w.json`:\n\n```json\n{\"troupe\": 1, \"types\": {}}\n```\n\n    troupe lint w.json\n", None),
    ("```json\n{\"troupe\": 1, \"types\": {\"a\": {}}}\n```\n", "does not load"),
    ("```json\n\"devices\": [1, 2\n```\n", "is no JSON"),
    ("```world\nposition( drive \"hover\" )\n```\n", "does not load"),
    ("```python\nimport sys\nsys.exit(3)\n```\n", "Python says"),
    ("```python\nenv = troupe.envs.Env(None)\n```\n", "none of its commands is run"),  # there is no gymnasium
    ("```cmake\nfind_package(troop)\n```\n", "no CMakeLists.txt"),
    ("See [there](nowhere.md).\n", "the link leads to nowhere.md"),
    ("# Here\n\nSee [there](#there).\n", "no heading #there"),
    ("Try `troupe run x.json --frobnicate`.\n", "the program has no --frobnicate"),
    ("It takes TIME_MEASURED.\n", "TIME_MEASURED stands for something else"),
]


class Stand:
    """A stand-in for the object that runs docs_test.py, with only the members that Page uses."""

    def __init__(self, scratch):
        self.scratch, self.build, self.installed, self.bin = scratch, scratch, scratch, scratch / "bin"
        self.bin.mkdir()
        (self.bin / "troupe").symlink_to(TROUPE)
        self.program, self.python, self.modules, self.used = docs_test.Program(TROUPE), sys.executable, set(), set()

    def tell(self, text):
        pass


wrong = 0
with tempfile.TemporaryDirectory() as folder:
    root = pathlib.Path(folder) / "root"
    shutil.copytree(docs_test.ROOT / "worlds", root / "worlds")
    shutil.copytree(docs_test.ROOT / "apps/examples", root / "apps/examples")
    (root / "tests/install").mkdir(parents=True)
    (root / "docs").mkdir()
    docs_test.ROOT = root
    scratch = pathlib.Path(folder) / "scratch"
    scratch.mkdir()
    stand = Stand(scratch)
    for number, (text, fault) in enumerate(PAGES):
        name = f"docs/page{number}.md"
        (root / name).write_text(text)
        found = docs_test.Page(stand, name).walk().faults
        if (fault is None and found) or (fault is not None and not any(fault in one for one in found)):
            wrong += 1
            print(f"page {number}:\n{text}\nshould have {fault or 'no fault'}; found:\n" + "\n".join(found) + "\n")
print(f"{len(PAGES)} pages, {wrong} judged wrongly")
sys.exit(1 if wrong else 0)
