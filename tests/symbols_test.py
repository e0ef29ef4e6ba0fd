#!/usr/bin/env python3
"""Tests that no arithmetic for the state uses inexact functions of the C library, whose bits differ between processors
(docs/determinism.md): the libraries that compute the state must not refer to a function of libm that is not exact. Also tests
that the Python module, in a wheel, would run with glibc 2.34 and the libstdc++ of gcc 11 (python/older_symbols.cpp).

    symbols_test.py [--module FILE] LIBRARY.a...

--module: the Python module, compiled with gcc without sanitizers. It is tested only on Debian 12, where wheels are made.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import unittest

LIBRARIES = []
MODULE = None

# Not in this list, because IEEE 754 fixes their bits: sqrt, fabs, floor, ceil, trunc, rint, round, fmod, remainder, ldexp,
# frexp, nextafter, fmin, fmax. fma is exact too, but a * b + c must mean the same thing everywhere: two roundings.
INEXACT = """sin cos tan sincos asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp exp2 exp10 expm1 log log2 log10
             log1p pow cbrt hypot erf erfc tgamma lgamma fma""".split()
UNDEFINED = re.compile(r"^\s*U (?:__)?(%s)(f|l)?(?:_finite)?(?:@.*)?$" % "|".join(INEXACT), re.M)


def inexact_symbols(nm_output):
    return sorted({match[1] + (match[2] or "") for match in UNDEFINED.finditer(nm_output)})


# Newer than glibc 2.34 or gcc 11, except the symbol that python/older_symbols.cpp replaces in a wheel.
TOO_NEW = re.compile(r"^\s*U ((?!_ZNSt18condition_variable4wait)\S+@(?:GLIBC_2\.(?:3[5-9]|[4-9]\d)"
                     r"|GLIBCXX_3\.4\.[3-9]\d|CXXABI_1\.3\.(?:1[4-9]|[2-9]\d)))$", re.M)


def is_debian_12():
    release = pathlib.Path("/etc/os-release")
    return release.exists() and "VERSION_CODENAME=bookworm" in release.read_text()


class TheLibraries(unittest.TestCase):
    def test_refer_to_no_inexact_function(self):
        self.assertTrue(LIBRARIES, "no libraries were given")
        for library in LIBRARIES:
            with self.subTest(library=library):
                symbols = subprocess.run(["nm", "--undefined-only", library], check=True, capture_output=True, text=True)
                self.assertEqual(inexact_symbols(symbols.stdout), [])


class TheModule(unittest.TestCase):
    def test_refers_to_no_symbol_that_is_too_new_for_a_wheel(self):
        if MODULE is None or not is_debian_12():
            self.skipTest("there is no module, or this system is not Debian 12")
        symbols = subprocess.run(["nm", "--dynamic", "--undefined-only", MODULE], check=True, capture_output=True, text=True)
        self.assertIn("@GLIBC_2", symbols.stdout)
        self.assertEqual(TOO_NEW.findall(symbols.stdout), [])


class PlantedSymbols(unittest.TestCase):
    def test_are_found(self):
        self.assertEqual(inexact_symbols("x.o:\n                 U sin\n                 U atan2f\n"), ["atan2f", "sin"])
        self.assertEqual(inexact_symbols("                 U __exp_finite\n                 U fma@GLIBC\n"), ["exp", "fma"])

    def test_exact_and_our_own_are_not(self):
        self.assertEqual(inexact_symbols("                 U sqrt\n                 U floor\n                 U memset\n"
                                         "                 U _ZN6troupe3sinEd\n0000000000000010 T sin\n"), [])


    def test_that_are_too_new_are_found(self):
        self.assertEqual(TOO_NEW.findall("                 U hypot@GLIBC_2.35\n                 U malloc@GLIBC_2.2.5\n"
                                         "                 U pthread_create@GLIBC_2.34\n                 U new@GLIBCXX_3.4.30\n"
                                         "                 U _ZNSt18condition_variable4waitER@GLIBCXX_3.4.30\n"),
                         ["hypot@GLIBC_2.35", "new@GLIBCXX_3.4.30"])


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--module")
    parser.add_argument("libraries", nargs="*")
    given = parser.parse_args()
    LIBRARIES, MODULE = given.libraries, given.module
    unittest.main(argv=sys.argv[:1])
