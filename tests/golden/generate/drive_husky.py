"""Regressions of the DRIVE data (data/drive_husky) that tests/program/golden_test.py expects, by numpy alone.
usage: drive_husky.py HUSKY_SAMPLES_CSV"""
import sys

import numpy as np

s = np.genfromtxt(sys.argv[1], delimiter=",", names=True)
states = np.stack([s["gyro_z"], s["icp_vx_fit"], s["icp_vy_fit"]], axis=1)
inputs = np.stack([s["wheel_left"], s["wheel_right"]], axis=1)
rows = np.flatnonzero(s["block"][1:] == s["block"][:-1])  # transitions inside a block
phi = np.concatenate([states[rows], inputs[rows]], axis=1)
beta, *_ = np.linalg.lstsq(phi, states[rows + 1] - states[rows], rcond=None)
print(len(rows))
print(np.array2string(beta.T, precision=12))
