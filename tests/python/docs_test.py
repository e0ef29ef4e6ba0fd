"""Every listing of docs/python.md runs, and prints what stands behind it."""

import contextlib
import io
import os
import re
import shutil
import unittest

from support import ROOT, InAFolder

PAGE = (ROOT / "docs" / "python.md").read_text()
LISTING = re.compile(r"```python\n(.*?)```\n(?:\n((?:    [^\n]*\n)+))?", re.S)


class Listings(InAFolder):
    def test_run_one_after_another(self):
        shutil.copytree(ROOT / "worlds", "worlds")
        listings = LISTING.findall(PAGE)
        self.assertGreaterEqual(len(listings), 6)
        names = {}
        for code, printed in listings:
            with self.subTest(code=code):
                out = io.StringIO()
                with contextlib.redirect_stdout(out):
                    exec(compile(code, "docs/python.md", "exec"), names)
                expected = re.sub(r"^    ", "", printed, flags=re.M)
                self.assertEqual(out.getvalue(), expected)

    def test_files_that_are_named_are_there(self):
        for name in re.findall(r"\]\(((?:\.\./)?[\w./-]+)", PAGE):
            self.assertTrue(os.path.exists(ROOT / "docs" / name), name)


if __name__ == "__main__":
    unittest.main()
