#!/usr/bin/env python3
"""DaISy's flexible robot arm: the first half of the samples trains, the second is held out."""
import numpy as np

from benchmark import Arguments
from one_experiment import experiment

PROTOCOL = """DATA/sysid_classic/robot_arm.dat, rows 0 to 511 train, ten lags of acceleration and torque, delay 0, no intercept, defaults else. FIT: 100 (1 - |y - y'| / |y - mean|). Free run: the first ten samples
measured, then the torque alone; the data's README fits its ARX models to rows 0 to 511, too. Its numbers are ours: DaISy publishes none."""
REFERENCE = [("ARX(4,5), data's README", "", "", "99.67", "77.06", ""), ("ARX(10,10), data's README", "", "", "99.96", "96.08", "")]


def main():
    given = Arguments(__doc__)
    u, y = np.loadtxt(given.data / "sysid_classic" / "robot_arm.dat").T
    experiment(given, "Robot arm (DaISy)", PROTOCOL, u, y, 1.0, (10, 10, 0), 512, False, REFERENCE)


if __name__ == "__main__":
    main()
