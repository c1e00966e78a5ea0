#!/usr/bin/env python3
"""Differences between two archives of the same data and configuration, made on different machines.

  compare_archives.py A.h5 B.h5

Prints how many datasets have the same bits, and whether decisions (whole numbers, text, chosen rows) are equal. Prints the
largest differences: theta in its standard errors, predictions in predicted standard deviations, log densities in nats, and
everything else relative to the largest value of its dataset.
"""
import sys

import h5py
import numpy as np


def datasets(file):
    names = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    return [n for n in names if not n.startswith(("provenance", "config"))]


def columns(value):
    """A table's columns, or the array itself."""
    if value.dtype.names:
        return {name: np.asarray(value[name]) for name in value.dtype.names}
    return {"": value}


def largest(x, y, unit):
    both = np.isfinite(x) & np.isfinite(y)
    if not (np.isfinite(x) == np.isfinite(y)).all():
        return np.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.max(np.where(x == y, 0.0, np.abs(x - y) / unit)[both], initial=0.0))


def unit_of(file, name, x):
    """(kind, unit) of a dataset's differences."""
    group, _, last = name.rpartition("/")
    if last == "parameters" and f"{group}/parameter_standard_error" in file:
        return "theta [standard errors]", file[f"{group}/parameter_standard_error"][()]
    if last in ("prediction", "innovation") and f"{group}/innovation_covariance" in file:
        variance = np.diagonal(file[f"{group}/innovation_covariance"][()], axis1=1, axis2=2)
        if variance.shape == x.shape:
            return "predictions [predicted standard deviations]", np.sqrt(variance)
    if last == "log_density":
        return "log densities [nats]", 1.0
    return "other", np.max(np.abs(x[np.isfinite(x)]), initial=1e-300)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    worst, decisions, same = {}, [], 0
    with h5py.File(sys.argv[1]) as a, h5py.File(sys.argv[2]) as b:
        names = datasets(a)
        if set(names) != set(datasets(b)):
            print("only in one:", *sorted(set(names) ^ set(datasets(b))))
        for name in [n for n in names if n in b]:
            x, y = np.asarray(a[name][()]), np.asarray(b[name][()])
            same += x.tobytes() == y.tobytes()
            for column, value in columns(x).items():
                other = columns(y)[column]
                path = f"{name}.{column}" if column else name
                if value.shape != other.shape or (value.dtype.kind != "f" and not (value == other).all()):
                    decisions.append(path)
                elif value.dtype.kind == "f":
                    kind, unit = unit_of(a, name, value)
                    worst.setdefault(kind, []).append((largest(value, other, unit), path))
    print(f"{same} of {len(names)} datasets hold the same bits; decisions that differ: {', '.join(decisions) or 'none'}")
    for kind, rows in sorted(worst.items()):
        rows.sort(reverse=True)
        print(f"{kind}: " + ", ".join(f"{size:.1e} {path}" for size, path in rows[:3]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
