#!/usr/bin/env python3
"""DART: the yaw rate of a 1:10 car on several floors, one and ten samples ahead, with either half of the runs training."""
import h5py
import numpy as np

from benchmark import SOURCES, Arguments, filters, head, held_out, line, modes, numbers, rows_of_runs, run, title_of

PROTOCOL = """DATA/dart/README.md: configs/dart.ini: 10 Hz, v_steer = speed * steering derived, two lags of state and inputs, delay 0, no intercept; folds by parity of the run's name; a sample
counts from the third of a run on (h ahead: from sample 2 + h on). Nats per sample / RMSE in rad/s; jumps: RMSE one step ahead where v_steer moved by more than 0.5.
The reference rows are that README's, computed from the same files; nobody has published one-step scores of these data."""
REFERENCE = [
    ("one global ARX(2,2), constant Gaussian (reference)", "-.671 / .331", "-4.879 / .960", ".348", "-1.434 / .314", "-3.818 / .870", ".930"),
    ("TVP, tuned for nats (reference)", "1.122 / .124", ".871 / .147", ".893", "1.405 / .181", "1.041 / .503", ".455")]
JUMP = 0.5


def jump_errors(archive, name):
    """One-step errors of a filter's mean where the driver's v_steer jumped, at held-out samples that all filters score."""
    every, found = filters(archive), []
    with h5py.File(archive) as file:
        for rows in rows_of_runs(file, "test").values():
            jumped = np.abs(np.diff(file["data/input"][rows, 0], prepend=np.nan)) > JUMP
            scored = np.all([np.isfinite(file[f"evaluation/{f}/log_density"][rows]) for f in every], axis=0)
            found.append(file[f"evaluation/{name}/innovation"][rows, 0][jumped & scored])
    return np.concatenate(found)


def rms(errors):
    return f"{np.sqrt(np.mean(np.square(errors))):.3f}"


def cells(archive, name):
    if name not in filters(archive):
        return ["–"] * 3
    one, ten = (held_out(archive, "horizon", filter=name, horizon=h) for h in (1, 10))
    return [f"{h['log_score']:.3f} / {numbers(h['rmse'], 3)}" for h in (one, ten)] + [rms(jump_errors(archive, name))]


def both_folds(given, runs, name, **options):
    config = SOURCES / "configs" / "dart.ini"
    return [run(given.program, config, given.out / f"{name}_A.h5", data__root=given.data, **options),
            run(given.program, config, given.out / f"{name}_B.h5", data__root=given.data, data__train=",".join(runs[1::2]),
                data__test=",".join(runs[0::2]), **options)]


def main():
    given = Arguments(__doc__)
    runs = sorted(file.stem for file in (given.data / "dart").glob("*.csv"))
    folds = both_folds(given, runs, "dart")
    head(given.program, "DART", PROTOCOL, ["predictor", "A: 1 step", "A: 10 steps", "A: jumps", "B: 1 step", "B: 10 steps", "B: jumps"])
    line(f"bank, {modes(folds[0])} and {modes(folds[1])} modes", *cells(folds[0], "bank"), *cells(folds[1], "bank"))
    names = list(dict.fromkeys(filters(folds[0], "combined") + filters(folds[1])))  # terms may be accepted in one fold only
    for name in names[1:]:
        line(title_of(name), *cells(folds[0], name), *cells(folds[1], name))
    for reference in REFERENCE:
        line(*reference)
    samples = [held_out(fold, "summary", filter="bank")["samples"] for fold in folds]
    both = [name for name in names if all(name in filters(fold) for fold in folds)]
    jumps = {name: [jump_errors(fold, name) for fold in folds] for name in both}
    print(f"\nscored: {samples[0]} samples in A, {samples[1]} in B; RMSE of the {' + '.join(str(len(errors)) for errors in jumps['bank'])} jumps of both: "
          + ", ".join(f"{name} {rms(np.concatenate(errors))}" for name, errors in jumps.items()))


if __name__ == "__main__":
    main()
