"""An archive's content as numpy arrays and pandas tables, read by h5py after one check of its hash."""
from __future__ import annotations

import os

import h5py
import numpy as np
import pandas

from . import _modebank

# Meaning of the axes of a bank's and the windows' arrays.
_AXES = {
    "A": ("modes", "states", "states"), "B": ("modes", "states", "inputs"), "c": ("modes", "states"),
    "Q": ("modes", "states", "states"), "Q_standard_error": ("modes", "states", "states"), "weight": ("modes",),
    "transition": ("modes", "modes"), "transition_standard_error": ("modes", "modes"),
    "initial_probability": ("modes",), "parameters": ("", "parameters"),
    "parameter_standard_error": ("modes", "parameters"), "parameter_covariance": ("modes", "parameters", "parameters"),
    "covariance": ("", "parameters", "parameters"), "standard_error": ("", "parameters"),
    "t_value": ("", "parameters"), "information": ("", "parameters"), "prior_sd": ("parameters",),
    "means": ("", "features"), "covariances": ("", "features", "features"),
}


class Array(np.ndarray):
    """A numpy array with labelled axes: names has a list of labels per axis, or None; units are as stored."""

    def __new__(cls, values, names=None, units=None):
        array = np.asarray(values).view(cls)
        array.names = names
        array.units = units
        return array

    def __array_finalize__(self, other):
        # An array made from this one (slices, sums) has other axes.
        self.names = None
        self.units = getattr(other, "units", None)


def _text(value):
    """Converts bytes to texts, and arrays with one element to numbers."""
    value = np.asarray(value)
    if value.dtype.kind == "S":
        value = np.char.decode(value, "utf-8")
    return value.item() if value.ndim == 0 else value.tolist() if value.dtype.kind == "U" else value


class Run:
    """The samples of one run of an archive: run["time"], run["state"] and run["input"] of the data, run["bank"] or another
    filter as a dictionary of its arrays, all with a row per sample."""

    def __init__(self, archive: Archive, name: str):
        """Throws KeyError where the archive has no such run."""
        self._archive = archive
        table = archive["/data/runs"]
        row = table[table["name"] == name]
        if len(row) == 0:
            raise KeyError(f"{archive.path} holds no run {name!r}; its runs are {', '.join(table['name'])}")
        self.name, self.role, self.file = name, row["role"].iloc[0], row["file"].iloc[0]
        self.lag_s = float(row["lag_s"].iloc[0])
        first = int(row["first"].iloc[0])
        self.rows = slice(first, first + int(row["samples"].iloc[0]))

    def __repr__(self):
        return f"{self._archive!r}.run({self.name!r})"

    def keys(self) -> list[str]:
        """Names of the arrays of the data and of the filters."""
        data = [name for name in self._archive["/data"] if name not in ("runs", "quantum")]
        filters = self._archive.attributes("/evaluation").get("filters", []) if "/evaluation" in self._archive else []
        return data + list(filters)

    def __getitem__(self, name: str) -> Array | dict[str, Array]:
        if name not in self.keys():
            raise KeyError(f"{name} is none of {', '.join(self.keys())}")
        if f"/data/{name}" in self._archive:
            return self._rows(f"/data/{name}")
        group = f"/evaluation/{name}"
        return {array: self._rows(f"{group}/{array}") for array in self._archive[group]}

    def _rows(self, path):
        return self._archive._values(path, self._archive._at(path), self.rows)


class Archive:
    """The results of one execution. archive["/evaluation/summary"] is a pandas table, archive["/bank/A"] an Array,
    archive["/config"] text, archive["/bank"] the names of a group's members."""

    def __init__(self, path: str | os.PathLike):
        """Throws DataError for a file that is not an archive, is damaged (its hash does not match) or of another schema."""
        self.path = os.fspath(path)
        _modebank.check_archive(self.path)
        self._file = h5py.File(self.path)

    def __repr__(self):
        return f"modebank.Archive({self.path!r})"

    def __str__(self):
        return self.screen()

    def __contains__(self, path: str) -> bool:
        return path in self._file

    def _at(self, path):
        if path not in self._file:
            raise KeyError(f"{self.path} holds no {path}")
        return self._file[path]

    def __getitem__(self, path: str) -> pandas.DataFrame | Array | list[str] | str:
        thing = self._at(path)
        if isinstance(thing, h5py.Group):
            return sorted(thing)
        return self._values(path, thing, slice(None) if thing.shape else ())

    def _values(self, path, dataset, rows):
        values = np.asarray(dataset[rows])
        if values.dtype.names is not None:
            return self._table(values)
        if values.dtype.kind == "S":
            return _text(values)
        units = self.attributes(path).get("units")
        return Array(values, self._names(path, values.ndim), units)

    def attributes(self, path: str = "/") -> dict:
        """Attributes of a group or dataset, by name: texts, lists of texts, numbers."""
        return {name: _text(value) for name, value in self._at(path).attrs.items()}

    def run(self, name: str) -> Run:
        """The samples of one run."""
        return Run(self, name)

    def _table(self, records):
        columns = {}
        for name in records.dtype.names:
            column = records[name]
            if column.dtype.kind == "S":
                columns[name] = np.char.decode(column, "utf-8").astype(object)
            elif column.ndim == 2:  # a column with one value per state
                labels = self.state_names if len(self.state_names) == column.shape[1] else range(column.shape[1])
                columns.update({f"{name}[{label}]": column[:, i] for i, label in enumerate(labels)})
            else:
                columns[name] = column
        return pandas.DataFrame(columns)

    def _names(self, path, dimensions):
        group, _, name = path.strip("/").rpartition("/")
        axes = _AXES.get(name)
        if axes is None or len(axes) != dimensions:
            return None
        group = self.attributes(group or "/")
        names = {"modes": None, "states": group.get("state_names", self.state_names),
                 "inputs": group.get("input_names", self.input_names),
                 "parameters": group.get("parameter_labels", group.get("parameter_names")),
                 "features": group.get("feature_names")}
        return tuple(names.get(axis) for axis in axes)

    @property
    def state_names(self) -> list[str]:
        """Names of the n states."""
        return self.attributes("/data").get("state_names", []) if "/data" in self else []

    @property
    def input_names(self) -> list[str]:
        """Names of the m inputs."""
        return self.attributes("/data").get("input_names", []) if "/data" in self else []

    @property
    def runs(self) -> list[str]:
        """Names of the runs."""
        return [name.decode() for name in self._file["/data/runs"]["name"]]

    @property
    def modes(self) -> int:
        """K, the number of modes."""
        return len(self["/bank/weight"])

    @property
    def motions(self) -> list[dict]:
        """Motions, the most used first: title, modes, use, stay_s, time_constant_s and gain (n_y, inputs), both with an error.
        Modes of one motion have the same parameters and differ in noise."""
        return _modebank.motions(self.path)

    @property
    def A(self) -> Array:
        """(K, n, n) matrices of the increment; the full form is I + A."""
        return self["/bank/A"]

    @property
    def B(self) -> Array:
        """(K, n, m) matrices of the inputs."""
        return self["/bank/B"]

    @property
    def c(self) -> Array:
        """(K, n) constant increments [state unit]."""
        return self["/bank/c"]

    @property
    def Q(self) -> Array:
        """(K, n, n) covariance of the process noise per step [state unit^2]."""
        return self["/bank/Q"]

    @property
    def C(self) -> Array:
        """(n_y, n) matrix of the measurement."""
        return self["/bank/C"]

    @property
    def R(self) -> Array:
        """(n_y, n_y) covariance of the measurement noise [state unit^2]."""
        return self["/bank/R"]

    @property
    def T(self) -> Array:
        """(K, K), row i: probabilities of the mode that follows mode i."""
        return self["/bank/transition"]

    @property
    def weights(self) -> Array:
        """(K,) weights: shares of the windows."""
        return self["/bank/weight"]

    @property
    def dt(self) -> float:
        """Sample period that one step of the bank stands for [s]."""
        return self.attributes("/bank")["dt_s"]

    @property
    def bank(self) -> _modebank.Bank:
        """The bank, for Filter and simulate."""
        return _modebank.Bank.load(self.path, "bank")

    @property
    def summary(self) -> pandas.DataFrame:
        """Scores of every filter by role and run."""
        return self["/evaluation/summary"]

    @property
    def evidence(self) -> dict:
        """What was found, in words (answer, text) and in the numbers that decided."""
        return self.attributes("/evaluation/evidence")

    @property
    def verdict(self) -> str:
        """The verdict on the bank's stated uncertainty on judged runs: calibrated, overconfident, ..."""
        table = self["/evaluation/diagnostics"]
        rows = table[(table["filter"] == "bank") & (table["mode"] == -1)]
        held_out = rows[rows["role"] == "test"]
        return (held_out if len(held_out) else rows)["verdict"].iloc[0]

    @property
    def config(self) -> str:
        """The resolved configuration, itself a valid configuration file."""
        return self["/config"]

    def screen(self, width: int = 100) -> str:
        """The answer on one screen, as `modebank show` begins."""
        return _modebank.screen(self.path, width)

    def text(self, width: int = 0) -> str:
        """The summary as `modebank show` prints it."""
        return _modebank.summary(self.path, width)
