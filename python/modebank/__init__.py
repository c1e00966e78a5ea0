"""Identifies motion that switches between modes from recorded runs: windows, mixtures, filter banks.

    import modebank
    archive = modebank.run("robot.ini")     # or {name: DataFrame, ...}: what `modebank run` does
    print(archive)                          # prints the answer on one screen
    archive.A, archive.summary              # arrays with names, pandas tables
    f = modebank.Filter(archive)            # a running filter
    f.step(t, u, y).prediction

Arrays have one sample, window or mode per row. Nothing is computed in Python.
"""
from __future__ import annotations

import os
import shutil
import tempfile
import warnings as _warnings
import weakref
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Union

import numpy as np
import pandas

from . import _modebank
from ._archive import Archive, Array, Run
from ._modebank import Bank, ConfigurationError, DataError, Estimate, Filter, Forecast, FreeRun, Mixture, Windows, __version__

Path = Union[str, os.PathLike]
Frames = Mapping[str, Union[pandas.DataFrame, Sequence[pandas.DataFrame]]]

__all__ = ["Archive", "Array", "Bank", "ConfigurationError", "DataError", "Estimate", "Filter", "Forecast", "FreeRun", "Mixture",
           "Run", "Windows", "fit_mixture", "identify", "read", "read_iddata", "run", "simulate"]


def _flat(keys):
    """Keys with their full names: window={"length": 30} becomes {"window.length": 30}."""
    flat = {}
    for key, value in keys.items():
        if isinstance(value, dict):
            flat.update({f"{key}.{name}": inner for name, inner in value.items()})
        else:
            flat[key] = value
    return flat


def _warn(line, callers=3):
    _warnings.warn(line, stacklevel=callers)


def run(data: Path | Frames, *, state: str | Sequence[str] | None = None, input: str | Sequence[str] | None = None,
        time: str | Sequence[str] | None = None, progress: Callable[[str], Any] | None = None, **keys: Any) -> Archive:
    """Runs the whole chain on runs and returns its Archive, as `modebank run` does.

    data: a configuration file, or {name: DataFrame} of one run each, or {name: (inputs, states)} of two frames with
    times of their own. To repeat such a run, pass the frames again, since its archive names no files. state and
    input: names of a frame's columns; time: its column of seconds (None: the index).
    progress: called with each line of progress. Further keys are those of the configuration, by **{"window.length":
    30} or window={"length": 30}; archive.output: path of the archive (for frames it is temporary without this key).
    Warnings are Python warnings. Releases the interpreter lock; Ctrl-C ends it at the next line of progress."""
    keys = _flat(keys)
    if isinstance(data, dict):
        return _run_frames(data, state, input, time, progress, keys)
    for name, value in (("data.state", state), ("data.input", input), ("data.time", time)):
        if value is not None:
            keys[name] = value
    return Archive(_modebank.run_file(os.fspath(data), keys, progress, _warn))


def _columns(name, frame, time):
    """A frame's columns as arrays, without a copy if they are contiguous. The index becomes a column, named time unless there is one."""
    columns = {str(label): frame[label] for label in frame.columns}
    index = frame.index
    if time is None and "time" not in columns and not isinstance(index, pandas.RangeIndex):
        columns["time"] = index
    elif index.name is not None:
        columns.setdefault(str(index.name), index)
    return {label: _values(name, label, column) for label, column in columns.items()}


def _values(name, label, column):
    if isinstance(column.dtype, pandas.DatetimeTZDtype):
        column = column.tz_convert(None) if isinstance(column, pandas.Index) else column.dt.tz_convert(None)
    values = column.to_numpy()
    kind = values.dtype.kind
    if kind == "M":
        return np.ascontiguousarray(values, dtype="datetime64[ns]")
    if kind == "i":
        return np.ascontiguousarray(values, dtype=np.int64)
    if kind in "fbu":
        return np.ascontiguousarray(values, dtype=np.float64)
    if kind in "OSU":
        missing = column.isna()
        return ["" if gone else str(value) for value, gone in zip(values, missing)]
    raise ConfigurationError(f"{name}: column {label} holds {values.dtype}, which are neither numbers, texts nor times")


def _run_frames(data, state, input, time, progress, keys):
    def warn(line):
        _warn(line, 5)  # stack level of the line that called run

    tables = {}
    for name, frames in data.items():
        frames = frames if isinstance(frames, (list, tuple)) else (frames,)
        tables[str(name)] = tuple(_columns(name, frame, time) for frame in frames)
    if state is not None:
        keys["data.state"] = state
    if input is not None:
        keys["data.input"] = input
    if time is not None:
        keys["data.time"] = time
    if keys.get("archive.output"):
        return Archive(_modebank.run_tables(tables, keys, progress, warn))
    folder = tempfile.mkdtemp(prefix="modebank-")
    try:
        keys["archive.output"] = os.path.join(folder, "archive.h5")
        archive = Archive(_modebank.run_tables(tables, keys, progress, warn))
    except BaseException:
        shutil.rmtree(folder)
        raise
    weakref.finalize(archive, shutil.rmtree, folder, ignore_errors=True)
    return archive


def read(log: Path, *, columns: Sequence[str] = (), **options: Any) -> dict[str, pandas.DataFrame]:
    """The tables of any readable log as {name: DataFrame}; the table of a CSV file has the name "".

    columns: names of columns, or of tables (topics) with all their columns; none: everything. options: keys of the configuration's [data] section on formats, such as separator="semicolon".
    Units, where the format states them, are in frame.attrs["units"] by column."""
    frames = {}
    for name, (columns, units) in _modebank.read_log(os.fspath(log), list(columns), options).items():
        frames[name] = pandas.DataFrame(columns)
        frames[name].attrs["units"] = {column: unit for column, unit in units.items() if unit}
    return frames


def read_iddata(file: Path, variable: str | None = None) -> dict[str, pandas.DataFrame]:
    """The experiments of an iddata object that MATLAB saved (-v7 or older) as {name: DataFrame}, which run takes.

    variable: the object's name, if the file has several. Outputs come first, then inputs, after the column "time"
    [s]; units are in frame.attrs["units"]. Needs scipy."""
    import scipy.io

    found = {name: value for name, value in scipy.io.loadmat(os.fspath(file)).items()
             if getattr(value, "classname", "") == "iddata"}
    if len(found) != 1 and variable not in found:
        raise ConfigurationError(f"{file} holds {len(found)} iddata objects: {', '.join(found)}; name one of them")
    record = found[variable or next(iter(found))][0, 0]

    def parts(field):
        return list(record[field].ravel()) if record[field].dtype == object else [record[field]]

    labels, units = ([str(text.item()) if text.size else "" for side in ("Output", "Input") for text in parts(side + of)]
                     for of in ("Name", "Unit"))
    frames = {}
    for name, outputs, inputs, step in zip(*map(parts, ("ExperimentName", "OutputData", "InputData", "Ts"))):
        if not step.size:
            raise DataError(f"{file}: experiment {name.item()} has no sample time: save SamplingInstants beside it")
        frame = pandas.DataFrame(np.hstack([outputs, inputs]).astype(float), columns=labels)
        frame.insert(0, "time", step.item() * np.arange(len(frame)))
        frame.attrs["units"] = dict(zip(labels, units))
        frames[str(name.item())] = frame
    return frames


def identify(states: np.ndarray | Sequence[np.ndarray], inputs: np.ndarray | Sequence[np.ndarray] | None = None,
             dt: float = 1.0, *, state_names: Sequence[str] = (), input_names: Sequence[str] = (),
             **options: Any) -> Windows:
    """Fits a local model to every window of a run and returns Windows.

    states: (N, n), or (N,) of one state, or a list of such arrays, one per run; inputs likewise (N, m), or None; dt:
    sample period [s]. options: the keys of the configuration's [window] section, as length=30, step=5, prior="none".
    Row-major arrays of doubles are read without a copy. Releases the interpreter lock; Ctrl-C ends it."""
    runs = list(states) if isinstance(states, (list, tuple)) else [states]
    if inputs is None:
        inputs = [np.empty((len(run), 0)) for run in runs]
    inputs = list(inputs) if isinstance(inputs, (list, tuple)) else [inputs]
    return _modebank.identify(runs, inputs, dt, list(state_names), list(input_names), options)


def simulate(bank: Archive | Bank | Path, states: np.ndarray, inputs: np.ndarray, dt: float | None = None, *,
             times: np.ndarray | None = None, samples: int = 1, **options: Any) -> FreeRun:
    """A free run: predicts the run after its first samples, from these and the inputs alone. Returns FreeRun.

    bank: an Archive, its path or a Bank; states: (N, n); only the first `samples` are used, later ones may be NaN, else
    log_density scores them; inputs: (N, m); dt: sample period [s] (None: the bank's), or times:
    (N,) [s]. options: further keys of the [filter] section. Ctrl-C ends it."""
    states = np.asarray(states, dtype=float)
    keys = {"simulate": samples, **options}
    if times is None:
        of = bank if isinstance(bank, Bank) else Bank.load(os.fspath(getattr(bank, "path", bank)))
        times = np.arange(len(states)) * (dt or of.dt or 1.0)
    return _modebank.simulate(bank, times, states, inputs, keys)


def fit_mixture(points: np.ndarray, components: int | str | Sequence[int] = "1..12", *, effective_samples: float = 0.0,
                seed: int = 1, **options: Any) -> Mixture:
    """Fits Gaussian mixtures to points (N, F) and returns the Mixture with the lowest BIC.

    components: a number, a list, or a range as "1..12"; effective_samples: number of independent samples to which the
    points amount, 0: all. options: further keys of the configuration's [mixture] section, as covariance="diagonal".
    Releases the interpreter lock; Ctrl-C ends it."""
    if isinstance(components, range):
        components = list(components)
    return _modebank.fit_mixture(points, effective_samples, seed, {"components": components, **options})
