"""Tests that the functions of troupe.math give the same bits as those in C++."""

import math
import unittest

import numpy as np
import troupe.math as tm
from support import ROOT


def bits(values):
    return np.asarray(values, np.float64).view(np.uint64).tolist()


ANGLES = np.concatenate([np.linspace(-700, 700, 4001), [0.0, -0.0, 1e22, 5e-324, math.pi / 6]])


class Functions(unittest.TestCase):
    def test_are_within_an_ulp_of_the_truth(self):
        some, positive = ANGLES[:4001], np.abs(ANGLES) + 1e-300
        for name, *arguments in [("sin", ANGLES), ("cos", ANGLES), ("exp", some), ("log", positive),
                                 ("atan2", ANGLES, ANGLES[::-1])]:
            truth = [getattr(math, name)(*each) for each in zip(*arguments)]  # from the C library: correct to half an ulp
            np.testing.assert_array_max_ulp(getattr(tm, name)(*arguments), np.array(truth), 1)
        self.assertEqual(bits(tm.sqrt(positive)), bits(np.sqrt(positive)))

    def test_have_the_bits_of_the_c_plus_plus(self):
        checked = 0
        for line in (ROOT / "tests" / "base" / "math_bits.txt").read_text().splitlines():
            if not line.startswith("#"):
                name, *arguments, result = line.split()
                numbers = [float.fromhex(argument) for argument in arguments if argument != "-"]
                self.assertEqual(bits([getattr(tm, name)(*numbers)]), bits([float.fromhex(result)]), line)
                self.assertEqual(bits(getattr(tm, name)(*([n] for n in numbers))), bits([float.fromhex(result)]), line)
                checked += 1
        self.assertGreaterEqual(checked, 60)

    def test_take_numbers_and_arrays(self):
        self.assertIsInstance(tm.sin(1), float)
        self.assertIsInstance(tm.atan2(1, np.float32(2)), float)
        self.assertEqual(tm.sin(np.float32(0.5)), tm.sin(0.5))
        self.assertEqual(tm.atan2(np.ones((3, 1)), np.ones(4)).shape, (3, 4))
        for y, x in ((np.ones(2), np.ones(3)), (np.ones((2, 3)), np.ones((2, 1, 2))), (np.ones(0), np.ones(2))):
            with self.assertRaises(ValueError) as raised:
                tm.atan2(y, x)
            self.assertEqual(str(raised.exception), f"atan2(): y has the shape {y.shape}, x has the shape {x.shape}: "
                                                    "give arrays of one shape, or arrays that NumPy can broadcast")
        self.assertEqual(tm.atan2(np.ones((2, 1, 0)), np.ones((3, 1))).shape, (2, 3, 0))
        self.assertEqual(tm.cos([]).shape, (0,))
        strided = ANGLES[::3]
        self.assertEqual(bits(tm.sin(strided)), bits([tm.sin(a) for a in strided]))
        sines, cosines = tm.sincos(strided.reshape(-1, 1))
        self.assertEqual(sines.shape, (strided.size, 1))
        self.assertEqual((bits(sines[:, 0]), bits(cosines[:, 0])), (bits(tm.sin(strided)), bits(tm.cos(strided))))

    def test_refuse_what_is_no_number(self):
        for value in ("x", None):
            for name in ("sin", "cos", "sincos", "exp", "log", "sqrt", "wrap_angle"):
                with self.subTest(name=name), self.assertRaisesRegex(TypeError, f": found {value!r}: give an array of numbers$"):
                    getattr(tm, name)(value)
            for name, arguments in (("y", (value, 1)), ("x", (1, value))):
                with self.assertRaisesRegex(TypeError, f"^{name}: found {value!r}: give an array of numbers$"):
                    tm.atan2(*arguments)

    def test_edges(self):
        self.assertTrue(np.isnan(tm.sin([np.nan, np.inf])).all())
        self.assertEqual(math.copysign(1, tm.sin(-0.0)), -1)
        self.assertEqual(tm.exp(1000), np.inf)
        self.assertEqual(tm.log(0), -np.inf)
        self.assertEqual(tm.wrap_angle(math.pi), math.pi)
        self.assertAlmostEqual(tm.wrap_angle(3 * math.pi + 0.5), -math.pi + 0.5)


class OrderedSums(unittest.TestCase):
    def test_go_from_first_to_last(self):
        values = np.random.default_rng(1).standard_normal((37, 100))
        for axis in (0, 1, -1):
            expected = []
            for row in np.moveaxis(values, axis, -1):
                total = 0.0
                for value in row.tolist():
                    total += value
                expected.append(total)
            self.assertEqual(bits(tm.ordered_sum(values, axis)), bits(expected))
        self.assertNotEqual(bits(tm.ordered_sum(values)), bits(values.sum(axis=-1)))  # else ordered_sum() would not be needed

    def test_shapes(self):
        self.assertEqual(tm.ordered_sum(np.ones((2, 3, 4))).shape, (2, 3))
        self.assertEqual(float(tm.ordered_sum([1, 2, 3.5])), 6.5)
        self.assertEqual(tm.ordered_sum(np.ones((5, 0))).tolist(), [0] * 5)
        self.assertEqual(tm.ordered_sum(np.ones((9, 3), np.float32)).dtype, np.float64)
        with self.assertRaises(ValueError):
            tm.ordered_sum(1.0)


if __name__ == "__main__":
    unittest.main()
