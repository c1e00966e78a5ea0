"""The hybrid systems of DATA/hybrid/simulate.py: their configuration, and one seed's scores beside the true guard's."""
import importlib.util

import numpy as np

from benchmark import filters, held_out, modes, run

CONFIG = """[data]
inputs = {folder}/run_*.csv
state = {states}
input = {inputs}
time = time
[window]
intercept = true
step = 5
[mixture]
components = 1..6
[bank]
transition = logit
[filter]
simulate = 1
"""
INPUTS = {"deadzone": "u", "contact": "force", "yaw": "v_steer, speed"}


def simulator(data):
    spec = importlib.util.spec_from_file_location("hybrid_simulate", data / "hybrid" / "simulate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def seed_scores(program, simulate, system, seed, folder):
    """Held-out scores of one seed: the bank, and the true parameters with the true guard and with a Markov chain."""
    runs = [simulate.simulate(system, 1500, seed, i) for i in range(12)]
    folder.mkdir(parents=True, exist_ok=True)
    simulate.write(system, runs, folder, False)
    config = folder / f"{system.name}.ini"
    config.write_text(CONFIG.format(folder=folder / system.name, states=", ".join(system.states),
                                    inputs=INPUTS[system.name]), encoding="utf-8")
    archive = run(program, config, folder / f"{system.name}.h5")
    train, test = runs[0::2], runs[1::2]
    one, free = simulate.truth(system, test)
    markov, _ = simulate.markov(system, train, test)
    bank, free_run = held_out(archive, "summary", filter="bank"), held_out(archive, "free_run", filter="bank")
    competitors = [held_out(archive, "free_run", filter=name) for name in filters(archive, "bank", "combined")]
    return {"true_modes": len(system.A), "modes": modes(archive), "score": float(bank["log_score"]),
            "truth": float(np.mean(np.concatenate(one[0]))), "markov": float(np.mean(np.concatenate(markov[0]))),
            "free": np.atleast_1d(free_run["rmse"]).tolist(), "free_truth": rms(free[1]),
            "free_competitor": np.min([np.atleast_1d(c["rmse"]) for c in competitors if c], axis=0).tolist()}


def rms(errors):
    return np.sqrt(np.mean(np.concatenate(errors) ** 2, 0)).tolist()
