#!/usr/bin/env python3
"""BorealTC, a Husky on flooring: configs/husky_ice.ini with either half of the runs training."""
from benchmark import Arguments
from halves import both_halves

PROTOCOL = """DATA/borealtc/FLOORING (without the runs that its README names), configs/husky_ice.ini, both halves of the runs train in turn; held-out log score [nats/sample] / one-step RMSE [rad/s],
samples too far and too close [%]. Others classify terrain with these data; of one-step predictions nothing is published. The last row is a published recipe for such a robot, run here."""
RECIPE = ("Salvi et al. 2025, configs/salvi2025.ini", "salvi2025.ini")


def main():
    both_halves(Arguments(__doc__), "FLOORING", PROTOCOL, "husky_ice.ini", "ICE", "FLOORING", RECIPE)


if __name__ == "__main__":
    main()
