#!/usr/bin/env python3
"""Hybrid systems: three simulated systems whose mode is a function of state and input (seed 1)."""
from benchmark import Arguments, head, line, numbers
from hybrid_systems import seed_scores, simulator

PROTOCOL = """DATA/hybrid/simulate.py, seed 1: twelve runs of 1500 samples, those at odd positions held out; intercept, window.step = 5, components = 1..6, bank.transition = logit.
Nats per sample one step ahead, joint over the states; free run: x[0] given, then inputs alone, RMSE per state. Nobody but us has published on these systems."""


def main():
    given = Arguments(__doc__)
    simulate = simulator(given.data)
    head(given.program, "Hybrid systems", PROTOCOL,
         ["system", "one step: bank", "true parameters, Markov modes", "true parameters and guard", "modes (true)", "free run: bank", "true guard", "best competitor"])
    for system in simulate.SYSTEMS:
        r = seed_scores(given.program, simulate, system, 1, given.out)
        line(system.name, f"{r['score']:.3f}", f"{r['markov']:.3f}", f"{r['truth']:.3f}", f"{r['modes']} ({r['true_modes']})",
             numbers(r["free"], 4), numbers(r["free_truth"], 4), numbers(r["free_competitor"], 3))


if __name__ == "__main__":
    main()
