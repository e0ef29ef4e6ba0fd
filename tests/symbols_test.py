#!/usr/bin/env python3
"""Tests that no arithmetic for the state uses inexact functions of the C library, whose bits differ between processors
(docs/determinism.md): the libraries that compute the state must not refer to a function of libm that is not exact.

    symbols_test.py LIBRARY.a...
"""

import re
import subprocess
import sys
import unittest

LIBRARIES = []

# Not in this list, because IEEE 754 fixes their bits: sqrt, fabs, floor, ceil, trunc, rint, round, fmod, remainder, ldexp,
# frexp, nextafter, fmin, fmax. fma is exact too, but a * b + c must mean the same thing everywhere: two roundings.
INEXACT = """sin cos tan sincos asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp exp2 exp10 expm1 log log2 log10
             log1p pow cbrt hypot erf erfc tgamma lgamma fma""".split()
UNDEFINED = re.compile(r"^\s*U (?:__)?(%s)(f|l)?(?:_finite)?(?:@.*)?$" % "|".join(INEXACT), re.M)


def inexact_symbols(nm_output):
    return sorted({match[1] + (match[2] or "") for match in UNDEFINED.finditer(nm_output)})


class TheLibraries(unittest.TestCase):
    def test_refer_to_no_inexact_function(self):
        self.assertTrue(LIBRARIES, "no libraries were given")
        for library in LIBRARIES:
            with self.subTest(library=library):
                symbols = subprocess.run(["nm", "--undefined-only", library], check=True, capture_output=True, text=True)
                self.assertEqual(inexact_symbols(symbols.stdout), [])


class PlantedSymbols(unittest.TestCase):
    def test_are_found(self):
        self.assertEqual(inexact_symbols("x.o:\n                 U sin\n                 U atan2f\n"), ["atan2f", "sin"])
        self.assertEqual(inexact_symbols("                 U __exp_finite\n                 U fma@GLIBC\n"), ["exp", "fma"])

    def test_exact_and_our_own_are_not(self):
        self.assertEqual(inexact_symbols("                 U sqrt\n                 U floor\n                 U memset\n"
                                         "                 U _ZN6troupe3sinEd\n0000000000000010 T sin\n"), [])


if __name__ == "__main__":
    LIBRARIES = sys.argv[1:]
    del sys.argv[1:]
    unittest.main()
