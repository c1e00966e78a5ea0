#!/usr/bin/env python3
"""Writes interpolation_knots.csv and interpolation_expected.csv into data/: numpy.interp on uneven knots.

Usage: /usr/bin/python3 tests/golden/generate/interpolation.py       (numpy 1.24)
The targets hold times before, between, exactly on and after the knots.
"""
import os

import numpy as np

here = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data")
generator = np.random.default_rng(20250500)
knots = np.cumsum(generator.uniform(0.001, 0.3, 60)) - 2.0
values = np.cumsum(generator.standard_normal(60))
targets = np.sort(np.concatenate([generator.uniform(knots[0] - 0.5, knots[-1] + 0.5, 140), knots[::7]]))


def write(name, time, value):
    with open(os.path.join(here, name), "w") as f:
        f.write("time,value\n")
        for t, v in zip(time.tolist(), value.tolist()):
            f.write(f"{t!r},{v!r}\n")


write("interpolation_knots.csv", knots, values)
write("interpolation_expected.csv", targets, np.interp(targets, knots, values))
