"""The hybrid systems of DATA/hybrid/simulate.py: their configuration, and one seed's scores beside the true guard's."""
import importlib.util

import h5py
import numpy as np

from benchmark import filters, held_out, modes, rows_of_runs, run

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
transition = {transition}
[filter]
simulate = 1
"""
INPUTS = {"deadzone": "u", "contact": "force", "yaw": "v_steer, speed"}


def simulator(data):
    spec = importlib.util.spec_from_file_location("hybrid_simulate", data / "hybrid" / "simulate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def seed_scores(program, simulate, system, seed, folder, transition="logit"):
    """Held-out scores of one seed: the bank, and the true parameters with the true transitions and with a Markov chain."""
    runs = [simulate.simulate(system, 1500, seed, i) for i in range(12)]
    folder.mkdir(parents=True, exist_ok=True)
    simulate.write(system, runs, folder, False)
    config = folder / f"{system.name}.ini"
    config.write_text(CONFIG.format(folder=folder / system.name, states=", ".join(system.states), inputs=INPUTS[system.name],
                                    transition=transition), encoding="utf-8")
    archive = run(program, config, folder / f"{system.name}_{transition}.h5")
    train, test = runs[0::2], runs[1::2]
    one, free = simulate.truth(system, test)
    markov, _ = simulate.markov(system, train, test)
    measured = np.concatenate([x[1:] for x, _, _ in test])
    bank, free_run = held_out(archive, "summary", filter="bank"), held_out(archive, "free_run", filter="bank")
    competitors = [held_out(archive, "free_run", filter=name) for name in filters(archive, "bank", "combined")]
    return {"system": system.name, "seed": seed, "true_modes": len(system.A), "modes": modes(archive),
            "score": float(bank["log_score"]), "truth": float(np.mean(np.concatenate(one[0]))),
            "markov": float(np.mean(np.concatenate(markov[0]))), "sd": measured.std(0).tolist(),
            "free": np.atleast_1d(free_run["rmse"]).tolist(), "free_score": float(free_run["log_score"]),
            "free_truth": rms(free[1]), "free_truth_score": float(np.mean(np.concatenate(free[0]))),
            "free_competitor": np.min([np.atleast_1d(c["rmse"]) for c in competitors if c], axis=0).tolist(),
            "accuracy": accuracy(archive, [m for _, _, m in test]),
            "logit": has_logit(archive), "stated": errors_stated(archive), "archive": str(archive)}


def rms(errors):
    return np.sqrt(np.mean(np.concatenate(errors) ** 2, 0)).tolist()


def has_logit(archive):
    with h5py.File(archive) as file:
        return "transition_weights" in file["bank"]


def errors_stated(archive):
    with h5py.File(archive) as file:
        return has_logit(archive) and bool(np.isfinite(file["bank/transition_weight_standard_error"][:]).all())


def accuracy(archive, truth):
    """Share of samples whose most probable filtered mode is the true mode of the step. Each mode of the bank stands for the true one
    with which it coincides most often. The true filter reaches 1, because states are measured exactly."""
    with h5py.File(archive) as file:
        said = [np.argmax(file["evaluation/bank/mode_probability"][rows], axis=1)[1:] for rows in rows_of_runs(file, "test").values()]
    said, led = np.concatenate(said), np.concatenate([m[:-1] for m in truth])
    return float(sum(np.bincount(led[said == mode]).max() for mode in np.unique(said)) / len(led))
