#!/usr/bin/env python3
"""A DC-DC buck converter (Aguirre et al. 2000): the first half of the samples trains, the second is held out."""
import numpy as np

from benchmark import Arguments
from one_experiment import experiment

PROTOCOL = """DATA/sysid_classic/buck_id.csv, rows 0 to 500 train, two lags of voltage and input, delay 1, an intercept, data.quantum = auto, defaults else. Readings come in steps of 0.2 V and repeat: they count
as intervals, and log scores are log(mass / quantum); that of the Gaussian ARX model is a density, which repeated readings make mean little. FIT: 100 (1 - |y - y'| / |y - mean|). Published models are fitted to all of this file and judged on a second one
that these data lack, so nothing published can stand beside the held-out columns."""
REFERENCE = [("ARX(2,2) fitted to the whole file, data's README", "", "", "", "58.90 (in sample)", "")]


def main():
    given = Arguments(__doc__)
    _, u, y = np.loadtxt(given.data / "sysid_classic" / "buck_id.csv", delimiter=",", skiprows=1).T
    experiment(given, "Buck converter", PROTOCOL, u, y, 1e-5, (2, 2, 1), 501, True, REFERENCE, "auto")


if __name__ == "__main__":
    main()
