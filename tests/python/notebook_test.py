"""Runs the code of docs/learning.ipynb, without Jupyter, and compares what it prints with the outputs in the notebook.

    notebook_test.py            the test
    notebook_test.py --write    replaces the outputs in the notebook, after a change of its code
"""

import base64
import contextlib
import io
import json
import sys
import unittest

from packages import run_with_packages
from support import ROOT

if __name__ == "__main__":
    run_with_packages()

try:
    import matplotlib
except ImportError:
    print("SKIPPED: the notebook needs the package matplotlib, which is not installed")
    sys.exit(77)

matplotlib.use("Agg")
import matplotlib.pyplot as plt

NOTEBOOK = ROOT / "docs" / "learning.ipynb"
MOST_BYTES = 150_000  # of the notebook: web hosts show no large ones


def pictures():
    """Returns the open figures as PNG, and closes them, as Jupyter does at the end of a cell."""
    shown = []
    for number in plt.get_fignums():
        file = io.BytesIO()
        plt.figure(number).savefig(file, format="png", dpi=80)
        shown.append(base64.b64encode(file.getvalue()).decode())
        plt.close(number)
    return shown


def run(notebook):
    """Executes the code cells in order. Returns a list of outputs per code cell, in the format of notebooks."""
    known, outputs = {"__name__": "__main__"}, []
    for index, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] != "code":
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("".join(cell["source"]), f"{NOTEBOOK.name}, cell {index}", "exec"), known)
        text = printed.getvalue()
        own = [{"name": "stdout", "output_type": "stream", "text": text.splitlines(keepends=True)}] if text else []
        own += [{"data": {"image/png": picture}, "metadata": {}, "output_type": "display_data"} for picture in pictures()]
        outputs.append(own)
    return outputs


def without_pictures(outputs):
    """Replaces pictures by a mark: their bytes depend on the version of matplotlib and on the fonts."""
    return [output if output["output_type"] == "stream" else "picture" for output in outputs]


class Notebook(unittest.TestCase):
    def test_prints_what_it_shows(self):
        notebook = json.loads(NOTEBOOK.read_text())
        cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
        for cell, outputs in zip(cells, run(notebook), strict=True):
            with self.subTest("".join(cell["source"]).splitlines()[0]):
                self.assertEqual(without_pictures(cell["outputs"]), without_pictures(outputs))
        self.assertEqual(sum(without_pictures(cell["outputs"]).count("picture") for cell in cells), 3)

    def test_is_small_and_in_order(self):
        notebook = json.loads(NOTEBOOK.read_text())
        self.assertLess(NOTEBOOK.stat().st_size, MOST_BYTES)
        counts = [cell["execution_count"] for cell in notebook["cells"] if cell["cell_type"] == "code"]
        self.assertEqual(counts, list(range(1, len(counts) + 1)))


def write():
    notebook = json.loads(NOTEBOOK.read_text())
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    for count, (cell, outputs) in enumerate(zip(cells, run(notebook)), 1):
        cell["outputs"], cell["execution_count"] = outputs, count
    NOTEBOOK.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        write()
    else:
        unittest.main()
