"""An archive's content as numpy and pandas have it. What is read, and how, is the library's: its hash is checked first."""
from __future__ import annotations

import os

import numpy as np
import pandas

from . import _modebank

# What the axes of a bank's and the windows' arrays are.
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
    """A numpy array that says what its axes are: names has a list of labels per axis, or None; units are as stored."""

    def __new__(cls, values, names=None, units=None):
        array = np.asarray(values).view(cls)
        array.names = names
        array.units = units
        return array

    def __array_finalize__(self, other):
        # What is made of an array (slices, sums) has other axes.
        self.names = None
        self.units = getattr(other, "units", None)


def _text(value):
    """Texts for bytes, numbers for arrays of one."""
    if value.dtype.kind == "S":
        value = np.char.decode(value, "utf-8")
    return value.item() if value.ndim == 0 else value.tolist() if value.dtype.kind == "U" else value


class Archive:
    """What one execution produced. archive["/evaluation/summary"] is a pandas table, archive["/bank/A"] an Array,
    archive["/config"] text, archive["/bank"] the names of a group's members."""

    def __init__(self, path: str | os.PathLike):
        """Throws DataError for a file that is no archive, is damaged (its hash does not match) or of a newer schema."""
        self.path = os.fspath(path)
        self._file = _modebank.ArchiveFile(self.path)

    def __repr__(self):
        return f"modebank.Archive({self.path!r})"

    def __str__(self):
        return self.screen()

    def __contains__(self, path: str) -> bool:
        try:
            self._file.attributes(path)
        except KeyError:
            return False
        return True

    def __getitem__(self, path: str) -> pandas.DataFrame | Array | list[str] | str:
        values = self._file.read(path)
        if isinstance(values, list):
            return values
        if values.dtype.names is not None:
            return self._table(values)
        if values.dtype.kind == "S":
            return _text(values)
        units = self.attributes(path).get("units")
        return Array(values, self._names(path, values.ndim), units)

    def attributes(self, path: str = "/") -> dict:
        """Of a group or dataset, by name: texts, lists of texts, numbers."""
        return {name: _text(value) for name, value in self._file.attributes(path).items()}

    def _table(self, records):
        columns = {}
        for name in records.dtype.names:
            column = records[name]
            if column.dtype.kind == "S":
                columns[name] = np.char.decode(column, "utf-8").astype(object)
            elif column.ndim == 2:  # one value per state
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
        """n names."""
        return self.attributes("/data").get("state_names", []) if "/data" in self else []

    @property
    def input_names(self) -> list[str]:
        """m names."""
        return self.attributes("/data").get("input_names", []) if "/data" in self else []

    @property
    def runs(self) -> list[str]:
        """Names of the runs."""
        return self.attributes("/data")["runs"]

    @property
    def modes(self) -> int:
        """K, how many modes the bank has."""
        return len(self["/bank/weight"])

    @property
    def A(self) -> Array:
        """(K, n, n) of the increment: the full form is I + A."""
        return self["/bank/A"]

    @property
    def B(self) -> Array:
        """(K, n, m)."""
        return self["/bank/B"]

    @property
    def c(self) -> Array:
        """(K, n) [state unit]."""
        return self["/bank/c"]

    @property
    def Q(self) -> Array:
        """(K, n, n) covariance of the process noise per step [state unit^2]."""
        return self["/bank/Q"]

    @property
    def C(self) -> Array:
        """(n_y, n)."""
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
        """(K,) shares of the windows."""
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
