#!/usr/bin/env python3
"""Reports words that readers of the documentation and the source did not understand, and suggests other words.

Searches documentation, comments, docstrings, messages and names: names such as `from_nobody` and `fromNobody` are also
found, and so is a phrase that a comment or a text breaks across lines.

    words_test.py [ROOT]          checks the files under ROOT (default: this repository), then itself on planted faults
    words_test.py --list [ROOT]   only prints the findings; exit code 1 if there are any
"""

import re
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Refused phrases, and what to write instead. A blank matches any gap between words, also a line break in a comment.
BODY = '"no robot", "a robot that", "any user": name the thing that is meant'
FAULT = 'programs "inject" a fault; in a robot a fault "occurs"'
WORDS = [
    ("anew", '"again", "new" or "rebuilt"'),
    ("nobody", BODY),
    ("nobodys", BODY),
    ("somebody", BODY),
    ("whoever", BODY),
    ("what never moves?", '"static geometry" or "the static scene"'),
    ("whatever never moves?", '"static geometry" or "the static scene"'),
    ("believe[sd]? to be", '"estimated pose" or "odometry estimate"'),
    ("foretold", '"unpredictable"'),
    ("foretell", '"predict"'),
    ("in the mean", '"on average" or "mean"'),
    ("by lot", '"random"'),
    ("nothing to say", '"not needed" or "no counterpart"'),
    ("a hair", '"slightly"'),
    ("befalls?", FAULT),
    ("befell", FAULT),
    ("befallen", FAULT),
    ("ailing", '"impaired"'),
    ("ailments?", '"impairment"'),
    ("homeless", "what the thing is, such as a body without a place"),
    ("furnish(?:e[sd]|ing)?(?! to do so)", '"provide" or "equip"'),  # the MIT licence has "furnished to do so"
]

# Names with a refused word that are allowed until they are renamed.
NAMES = ["ailments"]  # stored in checkpoints

SKIPPED = {".git", ".cache", "build", "out", "node_modules", "__pycache__"}  # folders
EXEMPT = {"LICENSE", "tests/words_test.py"}

GAP = r"(?:[\s\"'`*#_]|//[/!]?<?)+"
PATTERNS = [(re.compile(phrase.replace(" to do so", GAP + "to" + GAP + "do").replace(" ", GAP)), instead)
            for phrase, instead in WORDS]
NAME = re.compile(r"\w+")


def files(root):
    """Yields the text files under root, as (path relative to root, text)."""
    for path in sorted(root.rglob("*")):
        name = path.relative_to(root)
        if SKIPPED & set(name.parts) or name.as_posix() in EXEMPT or path.is_symlink() or not path.is_file():
            continue
        try:
            yield name.as_posix(), path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            pass  # not text: a picture, or input for the fuzzer


def is_word(text, start, end):
    """Whether text[start:end] consists of whole words, or of whole parts of a name such as fromNobody."""
    if re.search("[a-z][A-Z]", text[start:end]):
        return False  # NoBody is another word
    before, after = text[start - 1:start], text[end:end + 1]
    return (not before.isalpha() or (before.islower() and text[start].isupper())) and not after.islower()


def findings(root, names=(), used=None):
    """Returns the findings under root, as `path:line: text`. Adds the allowed names that occur to `used`."""
    found = []
    for name, text in files(root):
        lower = text.lower()
        for pattern, instead in PATTERNS:
            for match in pattern.finditer(lower):
                start, end = match.span()
                if not is_word(text, start, end):
                    continue
                around = next((n for n in NAME.finditer(text, text.rfind("\n", 0, start) + 1, end + 200)
                               if n.end() > start), None)
                if around and around[0] in names:
                    if used is not None:
                        used.add(around[0])
                    continue
                words = " ".join(re.split(GAP, match[0]))
                found.append((name, text.count("\n", 0, start) + 1, f'"{words}": write {instead}'))
    return [f"{name}:{line}: {what}" for name, line, what in sorted(found)]


class TheTree(unittest.TestCase):
    def test_there_are_files(self):
        self.assertGreater(sum(1 for _ in files(ROOT)), 20, ROOT)

    def test_it_has_none_of_the_words(self):
        used = set()
        found = findings(ROOT, NAMES, used)
        if found:
            self.fail(f"{len(found)} hard word(s):\n" + "\n".join(found))
        self.assertEqual(sorted(set(NAMES) - used), [], "these names are gone: remove them from NAMES")


class PlantedFaults(unittest.TestCase):
    """Tests the check with a small tree without refused words, into which one fault at a time is inserted."""

    GOOD = {
        "README.md": "Robots do not see their own body. It has no place; the new one is again in the meantime.\n",
        "LICENSE": "to whom the Software is furnished, and by whoever holds it\n",
        "docs/page.md": "A canewood chair, prevailing winds, a hairy failing plot.\nWhat\nnever ends. WhatHasNoBody.\n",
        "engine/world/world.cpp": "// to whom the Software is\n// furnished to do so, subject to\nint available = failing;\n",
        "build/x.txt": "nobody\n",
        "picture.png": b"\x89PNG nobody \xff",
    }

    def check(self, planted, names=()):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in {**self.GOOD, **planted}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_bytes(text if isinstance(text, bytes) else text.encode())
            return findings(root, names)

    def test_a_good_tree_has_none(self):
        self.assertEqual(self.check({}), [])

    def test_each_word_is_found_at_its_line(self):
        for name, text, expected in [
            ("docs/a.md", "\nIt is made anew.\n", 'docs/a.md:2: "anew": write "again", "new" or "rebuilt"'),
            ("docs/a.md", "Nobody is there.\n", 'docs/a.md:1: "nobody": write "no robot"'),
            ("docs/a.md", "That is nobody's.\n", '"nobody": write'),
            ("docs/a.md", "as somebody saw\n", '"somebody": write'),
            ("a.py", '"""Whoever calls it."""\n', 'a.py:1: "whoever": write'),
            ("docs/a.md", "of what never moves\n", '"what never moves": write "static geometry"'),
            ("engine/a.hpp", "/// for what\n  /// never moves, and\n", 'engine/a.hpp:1: "what never moves"'),
            ("engine/a.hpp", "int x;  ///< whatever never\n        ///< move\n", '"whatever never move"'),
            ("docs/a.md", "where a robot believes to be\n", '"believes to be": write "estimated pose"'),
            ("docs/a.md", "believed to be there\n", '"believed to be"'),
            ("docs/a.md", "is not to be foretold\n", '"foretold": write "unpredictable"'),
            ("docs/a.md", "cannot foretell\n", '"foretell": write "predict"'),
            ("docs/a.md", "0.5 m in the mean.\n", '"in the mean": write "on average"'),
            ("engine/a.cpp", 'f("how far, in "\n  "the mean");\n', 'engine/a.cpp:1: "in the mean"'),
            ("docs/a.md", "drawn by lot\n", '"by lot": write "random"'),
            ("docs/a.md", "| physics | nothing to say |\n", '"nothing to say": write "not needed"'),
            ("docs/a.md", "a hair less\n", '"a hair": write "slightly"'),
            ("docs/a.md", "faults befall robots\n", '"befall": write programs "inject"'),
            ("docs/a.md", "a fault that befell it\n", '"befell": write'),
            ("docs/a.md", "has befallen it\n", '"befallen": write'),
            ("docs/a.md", "an ailing robot\n", '"ailing": write "impaired"'),
            ("docs/a.md", "two ailments\n", '"ailments": write "impairment"'),
            ("docs/a.md", "homeless rows\n", '"homeless": write what the thing is'),
            ("docs/a.md", "furnished with sensors\n", '"furnished": write "provide"'),
            ("engine/a.cpp", "int from_nobody = 1;\n", '"nobody": write'),
            ("engine/a.cpp", "TEST(A, MovesNobody) {\n", '"nobody": write'),
            ("engine/a.cpp", "TEST(A, NobodyIsLost) {\n", '"nobody": write'),
            ("engine/a.cpp", "TEST(A, ThreadsChangeNobodysPlace) {\n", '"nobodys": write'),
            ("engine/a.cpp", "std::size_t ailing_ = 0;\n", '"ailing": write'),
            ("scripts/run", "# whoever runs it\n", '"whoever": write'),
            ("worlds/a.json", '{"title": "nobody"}\n', '"nobody": write'),
        ]:
            with self.subTest(text=text):
                found = self.check({name: text})
                self.assertEqual(len(found), 1, found)
                self.assertIn(expected, found[0])

    def test_each_rule_has_a_planted_fault(self):
        text = Path(__file__).read_text().split("test_each_word_is_found_at_its_line")[1].lower()
        for pattern, _ in PATTERNS:
            self.assertRegex(text, pattern)

    def test_names_may_stay_until_they_are_renamed(self):
        source = {"engine/a.cpp": "int k_nobody = 0;  // of nobody\n"}
        self.assertEqual(len(self.check(source)), 2)
        self.assertEqual(len(self.check(source, names=["k_nobody"])), 1)
        self.assertEqual(len(self.check(source, names=["nobody_else"])), 2)


if __name__ == "__main__":
    if "--list" in sys.argv:
        sys.argv.remove("--list")
        hard = findings(Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT, NAMES)
        print("\n".join(hard), end="\n" if hard else "")
        sys.exit(1 if hard else 0)
    if len(sys.argv) > 1:
        ROOT = Path(sys.argv.pop(1)).resolve()
    unittest.main()
