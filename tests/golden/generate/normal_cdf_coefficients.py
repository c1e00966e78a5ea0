#!/usr/bin/env python3
"""The polynomial of filter/step/detail/vector/mixture-inl.hpp: (1 + 2 t) exp(t^2) erfc(t) in s = (t - k) / (t + k), t >= 0.

Chebyshev interpolation after Shepherd & Laframboise 1981, "Chebyshev approximation of (1 + 2x) exp(x^2) erfc x in
0 <= x < infinity", Mathematics of Computation 36(153), in 60 digits (mpmath); prints the coefficients of s^0, s^1, ...
as powers and the largest relative error of double-precision Horner steps on a grid.
"""
import sys

import mpmath as mp

mp.mp.dps = 60
k = mp.mpf("3.75")
degree = int(sys.argv[1]) if len(sys.argv) > 1 else 23


def scaled(s):
    if s == 1:
        return 2 / mp.sqrt(mp.pi)
    t = k * (1 + s) / (1 - s)
    if t > 200:  # the asymptotic series of exp(t^2) erfc(t); mpmath's own erfc underflows far out
        terms = mp.mpf(1)
        term = mp.mpf(1)
        for i in range(1, 30):
            term *= -(2 * i - 1) / (2 * t * t)
            terms += term
        return (1 + 2 * t) * terms / (t * mp.sqrt(mp.pi))
    return (1 + 2 * t) * mp.exp(t * t) * mp.erfc(t)


n = degree + 1
nodes = [mp.cos(mp.pi * (2 * i + 1) / (2 * n)) for i in range(n)]
values = [scaled(s) for s in nodes]
chebyshev = [2 / mp.mpf(n) * sum(v * mp.cos(j * mp.pi * (2 * i + 1) / (2 * n)) for i, v in enumerate(values)) for j in range(n)]
chebyshev[0] /= 2
previous, current = [mp.mpf(1)], [mp.mpf(0), mp.mpf(1)]
powers = [mp.mpf(0)] * n
powers[0] += chebyshev[0]
for j in range(1, n):
    for i, c in enumerate(current):
        powers[i] += chebyshev[j] * c
    following = [mp.mpf(0)] + [2 * c for c in current]
    for i, c in enumerate(previous):
        following[i] -= c
    previous, current = current, following
for c in powers:
    print(mp.nstr(c, 20))
worst = 0
for i in range(4001):
    s = mp.mpf(-1) + mp.mpf(i) / 2000
    y = 0.0
    for c in reversed(powers):
        y = y * float(s) + float(c)
    worst = max(worst, abs(mp.mpf(y) / scaled(s) - 1))
print("# largest relative error", mp.nstr(worst, 3))
