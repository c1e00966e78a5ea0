#!/usr/bin/env python3
"""DRIVE: a Husky under random wheel commands, configs/drive_husky.ini with either half of the blocks training."""
from benchmark import Arguments
from halves import both_halves

PROTOCOL = """DATA/drive_husky/husky_samples.csv, configs/drive_husky.ini, both halves of the 201 blocks train in turn; held-out log score [nats/sample] / one-step RMSE [rad/s], samples too
far and too close [%]. The data's authors publish steady-state models of slip, no one-step predictions."""
# The settings for prediction alone that configs/drive_husky.ini names.
MORE = [("mixture as configs/husky_ice.ini has it",
         {"mixture.components": "12", "mixture.restarts": "20", "mixture.split_merge": "20"})]


def main():
    both_halves(Arguments(__doc__), "DRIVE Husky", PROTOCOL, "drive_husky.ini", more=MORE)


if __name__ == "__main__":
    main()
