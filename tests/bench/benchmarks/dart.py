#!/usr/bin/env python3
"""DART: the yaw rate of a 1:10 car on several floors, one and ten samples ahead, with either half of the runs training."""
import h5py
import numpy as np

from benchmark import FILTERS, SOURCES, Arguments, decoded, head, held_out, line, modes, numbers, run

PROTOCOL = """DATA/dart/README.md: configs/dart.ini: 10 Hz, v_steer = speed * steering derived, two lags of state and inputs, delay 0, no intercept; folds by parity of the run's name; a sample
counts from the third of a run on (h ahead: from sample 2 + h on). Nats per sample / RMSE in rad/s; jumps: RMSE one step ahead where v_steer moved by more than 0.5.
The reference rows are that README's, computed from the same files; nobody has published one-step scores of these data."""
REFERENCE = [
    ("one global ARX(2,2), constant Gaussian (reference)", "-.671 / .331", "-4.879 / .960", ".348", "-1.434 / .314", "-3.818 / .870", ".930"),
    ("TVP, tuned for nats (reference)", "1.122 / .124", ".871 / .147", ".893", "1.405 / .181", "1.041 / .503", ".455"),
    ("modebank 0.1.0 (f73a770), bank (reference)", ".603 / .290", "-.305 / .675", ".187", ".891 / .254", ".496 / .792", ".655")]
JUMP = 0.5
ALPHA = 0.99
ROWS = (*FILTERS, "combined")


def of_run(file, run_name):
    """Innovations and log densities, a column per filter, of the samples that all of them score; where v_steer jumped there."""
    each = lambda dataset, *column: np.stack([file[f"evaluation/{name}/{run_name}/{dataset}"][(slice(None), *column)] for name in FILTERS], axis=1)  # noqa: E731
    innovations, densities = each("innovation", 0), each("log_density")
    jumped = np.abs(np.diff(file[f"data/{run_name}/input"][:, 0], prepend=np.nan)) > JUMP
    scored = np.isfinite(densities).all(axis=1)
    return innovations[scored], densities[scored], jumped[scored]


def weights_of(densities, start):
    """Of the filters in the combined forecast of each sample: past densities, discounted by ALPHA (Raftery, Karny and Ettler 2010)."""
    weights, power = np.empty_like(densities), np.log(start)
    for k, density in enumerate(densities):
        weights[k] = np.exp(power - power.max()) / np.exp(power - power.max()).sum()
        power = ALPHA * np.log(np.maximum(weights[k], 1e-300)) + density
    return weights


def jump_errors(archive):
    """Errors of the mean one step ahead where the driver's v_steer jumped, held-out runs; a column per filter, then the combination."""
    with h5py.File(archive) as file:
        names = {role: [name for name, data in file["data"].items() if decoded(data.attrs["role"]) == role] for role in ("train", "test")}
        equal = np.full(len(FILTERS), 1.0 / len(FILTERS))
        start = np.concatenate([weights_of(of_run(file, name)[1], equal) for name in names["train"]]).mean(axis=0)
        found = []
        for name in names["test"]:
            innovations, densities, jumped = of_run(file, name)
            combined = (weights_of(densities, start) * innovations).sum(axis=1)
            found.append(np.column_stack([innovations, combined])[jumped])
    return np.concatenate(found)


def rms(errors, name):
    return f"{np.sqrt(np.mean(np.square(errors[:, ROWS.index(name)]))):.3f}"


def cells(archive, name):
    one, ten = (held_out(archive, "horizon", filter=name, horizon=h) for h in (1, 10))
    return [f"{h['log_score']:.3f} / {numbers(h['rmse'], 3)}" for h in (one, ten)] + [rms(jump_errors(archive), name)]


def both_folds(given, runs, name, **options):
    config = SOURCES / "configs" / "dart.ini"
    return [run(given.program, config, given.out / f"{name}_A.h5", data__root=given.data, **options),
            run(given.program, config, given.out / f"{name}_B.h5", data__root=given.data, data__train=",".join(runs[1::2]),
                data__test=",".join(runs[0::2]), **options)]


def main():
    given = Arguments(__doc__)
    runs = sorted(file.stem for file in (given.data / "dart").glob("*.csv"))
    steady, folds = both_folds(given, runs, "steady", bank__drift="none"), both_folds(given, runs, "drift")
    head(given.program, "DART", PROTOCOL, ["predictor", "A: 1 step", "A: 10 steps", "A: jumps", "B: 1 step", "B: 10 steps", "B: jumps"])
    line(f"bank, {modes(folds[0])} and {modes(folds[1])} modes that may drift", *cells(folds[0], "bank"), *cells(folds[1], "bank"))
    line(f"bank, {modes(steady[0])} and {modes(steady[1])} modes, bank.drift = none", *cells(steady[0], "bank"), *cells(steady[1], "bank"))
    for name in ROWS[1:]:
        line("all of them combined" if name == "combined" else f"competitor: {name}", *cells(folds[0], name), *cells(folds[1], name))
    for reference in REFERENCE:
        line(*reference)
    samples = [held_out(fold, "summary", filter="bank")["samples"] for fold in folds]
    jumps = [jump_errors(fold) for fold in folds]
    print(f"\nscored: {samples[0]} samples in A, {samples[1]} in B; RMSE of the {len(jumps[0])} + {len(jumps[1])} jumps of both: "
          + ", ".join(f"{name} {rms(np.concatenate(jumps), name)}" for name in ROWS))


if __name__ == "__main__":
    main()
