"""Writes valid HDF5 files as loggers make them: h5py_files.py FOLDER.

Each holds time = k / 4, wz = k and a = 2 k for k = 0 .. 19.
"""
import pathlib
import shutil
import sys

import h5py
import numpy as np

N = 20
folder = pathlib.Path(sys.argv[1])
k = np.arange(N, dtype=float)
columns = {"time": k / 4, "wz": k, "a": 2 * k}


def write(name, make=None, **options):
    with h5py.File(folder / name, "w", **options) as file:
        if make:
            make(file)
        else:
            for column, values in columns.items():
                file[column] = values


def preallocated(fill):
    """40 rows in chunks of 5; HDF5 allocates only the written ones."""
    def make(file):
        for column, values in columns.items():
            file.create_dataset(column, (2 * N,), "f8", chunks=(5,), fillvalue=fill)[:N] = values
    return make


def spare(file):
    for column, values in columns.items():
        file[column] = values
    file.create_dataset("spare", (10**9,), "f8", chunks=(10**6,))


def nested(file):
    rows = np.zeros(N, [("time", "f8"), ("imu", [("wz", "f8"), ("name", "S4")]), ("cmd", [("wheel", [("a", "f8")])])])
    rows["time"], rows["imu"]["wz"], rows["cmd"]["wheel"]["a"] = columns["time"], columns["wz"], columns["a"]
    rows["imu"]["name"] = [b"n%d" % i for i in range(N)]
    file["log"] = rows


def compressed(file):
    for column, values in columns.items():
        file.create_dataset(column, data=values, compression="lzf").attrs["units"] = "m"


for block in (512, 4096, 65536):
    write(f"userblock_{block}.h5", userblock_size=block)
write("zeros.h5", preallocated(0.0))
write("nans.h5", preallocated(np.nan))
write("spare.h5", spare)
write("nested.h5", nested)
write("lzf.h5", compressed)
with h5py.File(folder / "writer.h5", "w", libver="latest") as file:
    for column in columns:
        file.create_dataset(column, (0,), "f8", maxshape=(None,), chunks=(8,))
    file.swmr_mode = True
    for column, values in columns.items():
        file[column].resize((N,))
        file[column][...] = values
        file[column].flush()
    shutil.copy(folder / "writer.h5", folder / "swmr.h5")  # a copy as a killed recorder leaves it
