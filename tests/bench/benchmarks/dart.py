#!/usr/bin/env python3
"""DART: the yaw rate of a 1:10 car on several floors, one and ten samples ahead, with either half of the runs training."""
import h5py
import numpy as np

from benchmark import FILTERS, SOURCES, Arguments, head, held_out, line, modes, numbers, run
from dart_prepare import prepare

PROTOCOL = """DATA/dart/README.md: configs/dart.ini: 10 Hz, v_steer = speed * steering made before, two lags of state and inputs, delay 0, no intercept; folds by parity of the run's name; a sample
counts from the third of a run on (h ahead: from sample 2 + h on). Nats per sample / RMSE in rad/s; jumps: RMSE one step ahead where v_steer moved by more than 0.5.
The reference rows are that README's, computed from the same files; nobody has published one-step scores of these data."""
REFERENCE = [
    ("one global ARX(2,2), constant Gaussian (reference)", "-.671 / .331", "-4.879 / .960", ".348", "-1.434 / .314", "-3.818 / .870", ".930"),
    ("TVP, tuned for nats (reference)", "1.122 / .124", ".871 / .147", ".893", "1.405 / .181", "1.041 / .503", ".455"),
    ("modebank 0.1.0 (f73a770), bank (reference)", ".603 / .290", "-.305 / .675", ".187", ".891 / .254", ".496 / .792", ".655")]
JUMP = 0.5


def jump_rmse(archive, name):
    """One step ahead, where the driver's v_steer jumped, over the held-out runs."""
    squares = []
    with h5py.File(archive) as file:
        for run_name, data in file["data"].items():
            if data.attrs["role"] != b"test" or len(data["time"]) < 3:
                continue
            jumped = np.abs(np.diff(data["input"][:, 0], prepend=np.nan)) > JUMP
            jumped[:2] = False
            innovation = file[f"evaluation/{name}/{run_name}/innovation"][:, 0]
            squares.append(innovation[jumped] ** 2)
    joined = np.concatenate(squares)
    return f"{np.sqrt(np.nanmean(joined)):.3f}" if np.isfinite(joined).any() else "-"


def cells(archive, name):
    if not (one := held_out(archive, "summary", filter=name)):
        return ["-", "-", "-"]
    ten = held_out(archive, "horizon", filter=name, horizon=10)
    return [f"{one['log_score']:.3f} / {numbers(one['rmse'], 3)}", f"{ten['log_score']:.3f} / {numbers(ten['rmse'], 3)}", jump_rmse(archive, name)]


def both_folds(given, runs, name, **options):
    config = SOURCES / "configs" / "dart.ini"
    return [run(given.program, config, given.out / f"{name}_A.h5", data__root=given.out, **options),
            run(given.program, config, given.out / f"{name}_B.h5", data__root=given.out, data__train=",".join(runs[1::2]),
                data__test=",".join(runs[0::2]), **options)]


def main():
    given = Arguments(__doc__)
    (given.out / "dart").mkdir(exist_ok=True)
    runs = sorted(file.stem for file in (given.data / "dart").glob("*.csv"))
    for name in runs:
        prepare(given.data / "dart" / f"{name}.csv", given.out / "dart" / f"{name}.csv")
    steady, folds = both_folds(given, runs, "steady", bank__drift="none"), both_folds(given, runs, "drift")
    head(given.program, "DART", PROTOCOL, ["predictor", "A: 1 step", "A: 10 steps", "A: jumps", "B: 1 step", "B: 10 steps", "B: jumps"])
    line(f"bank, {modes(folds[0])} and {modes(folds[1])} modes that may drift", *cells(folds[0], "bank"), *cells(folds[1], "bank"))
    line(f"bank, {modes(steady[0])} and {modes(steady[1])} modes, bank.drift = none", *cells(steady[0], "bank"), *cells(steady[1], "bank"))
    for name in FILTERS[1:]:
        line(f"competitor: {name}", *cells(folds[0], name), *cells(folds[1], name))
    for reference in REFERENCE:
        line(*reference)
    samples = [held_out(fold, "summary", filter="bank")["samples"] for fold in folds]
    print(f"\nscored: {samples[0]} samples in A, {samples[1]} in B")


if __name__ == "__main__":
    main()
