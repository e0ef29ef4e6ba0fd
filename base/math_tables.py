#!/usr/bin/env python3
"""Prints base/math_tables.hpp: the constants of base/math.cpp, worked out with mpmath at 400 digits.

usage: base/math_tables.py > base/math_tables.hpp
"""

import mpmath as mp

mp.mp.dps = 400


def rounded(x):
    """The double nearest to x."""
    return float(x)


def cut(x, lowest_bit):
    """x rounded to a multiple of 2^lowest_bit: a short double."""
    return mp.nint(mp.ldexp(x, -lowest_bit)) * mp.ldexp(mp.mpf(1), lowest_bit)


def literal(x):
    return float(x).hex()


def constant(text, name, x):
    print(f"\n/// {text}\ninline constexpr double {name} = {literal(x)};")


def array(text, name, xs, columns):
    print(f"\n/// {text}\ninline constexpr double {name}[{len(xs)}] = {{")
    for i in range(0, len(xs), columns):
        print("    " + ", ".join(literal(x) for x in xs[i : i + columns]) + ",")
    print("};")


def polynomial(text, name, f, low, high, terms):
    """Interpolates f at the Chebyshev nodes of [low, high], near the best polynomial; lowest power first."""
    nodes = [
        (low + high) / 2 + (high - low) / 2 * mp.cos(mp.pi * (2 * i + 1) / (2 * terms)) for i in range(terms)
    ]
    matrix = mp.matrix(terms, terms)
    for i, z in enumerate(nodes):
        for j in range(terms):
            matrix[i, j] = z**j
    coefficients = mp.lu_solve(matrix, mp.matrix([f(z) for z in nodes]))
    array(text, name, list(coefficients), 3)


print("// Made by base/math_tables.py; not edited by hand.\n// clang-format off\n#pragma once\n")
print("#include <cstdint>\n\nnamespace troupe::math_tables {")

# -- the reduction by pi/2: three parts of at most 33 bits, so that their products with a 20-bit integer are
#    exact, and what is left of it
rest = mp.pi / 2
parts = []
for lowest in (-32, -65, -98):
    part = cut(rest, lowest)
    parts.append(part)
    rest -= part
array(
    "pi/2 in three short parts and a rest; the parts times an integer below 2^20 are exact.",
    "k_half_pi_parts", parts + [rest], 2)
hi = mp.mpf(rounded(mp.pi / 2))
array("pi/2 as an unevaluated sum of two doubles.", "k_half_pi", [hi, mp.pi / 2 - hi], 2)
constant("2/pi.", "k_two_over_pi", 2 / mp.pi)
constant("1/(2 pi).", "k_one_over_two_pi", 1 / (2 * mp.pi))

words = [int(mp.floor(mp.ldexp(2 / mp.pi, 32 * (i - 1)))) & 0xFFFFFFFF for i in range(42)]
print("\n/// The binary digits of 2/pi, 32 a word, the highest first; the point stands behind the second word.")
print(f"inline constexpr std::uint32_t k_two_over_pi_digits[{len(words)}] = {{")
for i in range(0, len(words), 8):
    print("    " + ", ".join(f"0x{w:08x}" for w in words[i : i + 8]) + ",")
print("};")


top = (mp.pi / 4 + mp.mpf(2) ** -20) ** 2
polynomial(
    "(sin(x)/x - 1)/x^2 in powers of x^2 for |x| <= pi/4.", "k_sin",
    lambda z: (mp.sin(mp.sqrt(z)) / mp.sqrt(z) - 1) / z, mp.mpf(0), top, 7)
polynomial(
    "(cos(x) - 1 + x^2/2)/x^4 in powers of x^2 for |x| <= pi/4.", "k_cos",
    lambda z: (mp.cos(mp.sqrt(z)) - 1 + z / 2) / z**2, mp.mpf(0), top, 6)

# -- atan at the multiples of 1/32; below 4/32 the polynomial does without
polynomial(
    "(atan(x)/x - 1)/x^2 in powers of x^2 for |x| <= 0.11.", "k_atan",
    lambda z: (mp.atan(mp.sqrt(z)) / mp.sqrt(z) - 1) / z, mp.mpf(0), mp.mpf("0.11") ** 2, 8)
rows = []
for k in range(33):
    value = mp.atan(mp.mpf(k) / 32) if k >= 4 else mp.mpf(0)
    hi = mp.mpf(rounded(value))
    rows += [mp.mpf(k) / 32 if k >= 4 else mp.mpf(0), hi, value - hi]
array("For k = 0 .. 32: c = k/32 (0 for k < 4) and atan(c) as a sum of two doubles.", "k_atan_table", rows, 3)

# -- exp: 2^(j/32)
part = cut(mp.log(2) / 32, -42)
constant("ln(2)/32, short: its product with an integer below 2^16 is exact.", "k_ln2_over_32_hi", part)
constant("What is left of ln(2)/32.", "k_ln2_over_32_lo", mp.log(2) / 32 - part)
constant("32/ln(2).", "k_32_over_ln2", 32 / mp.log(2))
edge = mp.log(2) / 64 * mp.mpf("1.001")
polynomial(
    "(exp(x) - 1 - x)/x^2 in powers of x for |x| <= ln(2)/64.", "k_exp",
    lambda x: (mp.exp(x) - 1 - x) / x**2 if abs(x) > mp.mpf(10) ** -50 else mp.mpf(0.5), -edge, edge, 5)
rows = []
for j in range(32):
    value = mp.mpf(2) ** (mp.mpf(j) / 32)
    hi = mp.mpf(rounded(value))
    rows += [hi, value - hi]
array("For j = 0 .. 31: 2^(j/32) as a sum of two doubles.", "k_exp_table", rows, 2)

# -- log: the argument m in [0.6875, 1.375), 128 intervals of its leading bits
start = mp.mpf("0.6875")
low_bits = 0x3FE6000000000000
rows = []
widest = mp.mpf(0)


def as_double(bits):
    import struct

    return mp.mpf(struct.unpack("<d", struct.pack("<Q", bits))[0])


for j in range(128):
    a = as_double(low_bits + (j << 45))
    b = as_double(low_bits + ((j + 1) << 45))
    c = mp.mpf(1) if (b == 1 or a == 1) else cut(2 / (a + b), -9)
    widest = max(widest, abs(a * c - 1), abs(b * c - 1))
    value = -mp.log(c)
    hi = cut(value, -42)
    rows += [c, hi, value - hi]
assert widest <= mp.mpf(2) ** -7
part = cut(mp.log(2), -42)
constant("ln(2), a multiple of 2^-42: its product with an exponent is exact.", "k_ln2_hi", part)
constant("What is left of ln(2).", "k_ln2_lo", mp.log(2) - part)
array(
    "For the 128 intervals of m in [0.6875, 1.375): c near 1/m to 9 bits; -ln(c) to 2^-42, and the rest.",
    "k_log_table", rows, 3)
array(
    "(ln(1 + x) - x + x^2/2)/x^3 in powers of x for |x| <= 2^-7: the Taylor series.", "k_log",
    [mp.mpf((-1) ** n) / (n + 3) for n in range(7)], 3)

print("\n}  // namespace troupe::math_tables")
