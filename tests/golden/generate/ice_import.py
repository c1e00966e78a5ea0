#!/usr/bin/env python3
"""Writes ice_import.csv into data/: what an import of the Husky-on-ice runs must give, by numpy alone.

Usage: /usr/bin/python3 tests/golden/generate/ice_import.py FOLDER        FOLDER holds borealtc/ICE
One row per run: samples, first and last time, mean of wz (numpy.interp to the pro times inside the imu's span), of its
square and of velL and velR.
"""
import glob
import os
import sys

import numpy as np

here = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data")
rows = []
for pro in sorted(glob.glob(os.path.join(sys.argv[1], "borealtc", "ICE", "pro_*.csv"))):
    p = np.genfromtxt(pro, delimiter=",", names=True)
    q = np.genfromtxt(pro.replace("pro_", "imu_"), delimiter=",", names=True)
    p = p[(p["time"] >= q["time"][0]) & (p["time"] <= q["time"][-1])]
    wz = np.interp(p["time"], q["time"], q["wz"])
    rows.append([os.path.basename(pro)[4:-4], len(p)] + [float(x) for x in (
        p["time"][0], p["time"][-1], wz.mean(), (wz ** 2).mean(), p["velL"].mean(), p["velR"].mean())])
with open(os.path.join(here, "ice_import.csv"), "w") as f:
    f.write("run,samples,first,last,mean_wz,mean_wz_squared,mean_velL,mean_velR\n")
    for row in rows:
        f.write(",".join(str(x) if isinstance(x, str) else repr(x) for x in row) + "\n")
