#!/usr/bin/env python3
"""DART: the yaw rate of a 1:10 car on several floors, one and ten samples ahead, with either half of the runs training."""
import h5py
import numpy as np

from benchmark import FILTERS, Arguments, head, held_out, line, modes, numbers, run

PROTOCOL = """DATA/dart/README.md: 10 Hz, v_steer = speed * steering made before, two lags of state and inputs, delay 0, no intercept; folds by parity of the run's name; a sample
counts from the third of a run on (h ahead: from sample 2 + h on). Nats per sample / RMSE in rad/s; jumps: RMSE one step ahead where v_steer moved by more than 0.5.
The reference rows are that README's, computed from the same files; nobody has published one-step scores of these data."""
CONFIG = """[data]
inputs = {}/*.csv
state = yaw_rate
input = v_steer, speed
time = time
rate_hz = 10
[window]
model = varx
state_lags = 2
input_lags = 2
input_delay = 0
[filter]
noise = adaptive
horizon = 1, 10
"""
REFERENCE = [
    ("one global ARX(2,2), constant Gaussian (reference)", "-.671 / .331", "-4.879 / .960", ".348", "-1.434 / .314", "-3.818 / .870", ".930"),
    ("TVP, tuned for nats (reference)", "1.122 / .124", ".871 / .147", ".893", "1.405 / .181", "1.041 / .503", ".455"),
    ("modebank 0.1.0 (f73a770), bank (reference)", ".603 / .290", "-.305 / .675", ".187", ".891 / .254", ".496 / .792", ".655")]
JUMP = 0.5


def prepare(data, out):
    """The files with the column v_steer = speed * steering; their names in order."""
    out.mkdir(exist_ok=True)
    for file in sorted((data / "dart").glob("*.csv")):
        names = file.read_text(encoding="utf-8").split("\n", 1)[0].split(",")
        values = np.genfromtxt(file, delimiter=",", skip_header=1)
        made = values[:, names.index("speed")] * values[:, names.index("steering")]
        np.savetxt(out / file.name, np.c_[values, made], "%.9g", ",", header=",".join([*names, "v_steer"]), comments="")
    return sorted(file.stem for file in out.glob("*.csv"))


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


def main():
    given = Arguments(__doc__)
    runs = prepare(given.data, given.out / "csv")
    config = given.out / "dart.ini"
    config.write_text(CONFIG.format(given.out / "csv"), encoding="utf-8")
    folds = [run(given.program, config, given.out / "A.h5"),
             run(given.program, config, given.out / "B.h5", data__train=",".join(runs[1::2]), data__test=",".join(runs[0::2]))]
    head(given.program, "DART", PROTOCOL, ["predictor", "A: 1 step", "A: 10 steps", "A: jumps", "B: 1 step", "B: 10 steps", "B: jumps"])
    for name in FILTERS:
        of_folds = [cells(fold, name) for fold in folds]
        title = f"bank, {modes(folds[0])} and {modes(folds[1])} modes" if name == "bank" else f"competitor: {name}"
        line(title, *of_folds[0], *of_folds[1])
    for reference in REFERENCE:
        line(*reference)
    samples = [held_out(fold, "summary", filter="bank")["samples"] for fold in folds]
    print(f"\nscored: {samples[0]} samples in A, {samples[1]} in B")


if __name__ == "__main__":
    main()
