#!/usr/bin/python3
"""Writes the files of pandas that tests/io/arrays reads: tests/golden/data/pandas_*.h5. Needs pandas and PyTables.

Usage: pandas_files.py tests/golden/data
"""
import sys

import numpy as np
import pandas as pd

out = sys.argv[1]
k = np.arange(4)
frame = pd.DataFrame({"v": 0.5 * k, "steer": 0.1 * k - 0.2, "gear": k.astype("int32"), "name": ["a", "b", "c", "dd"]},
                     index=pd.Index(0.1 * k, name="time"))
numbers = frame[["v", "steer", "gear"]]
stamped = numbers.set_index(pd.to_datetime(1_700_000_000 * 10**9 + 100_000_000 * k).rename("stamp"))
numbers.to_hdf(f"{out}/pandas_fixed.h5", "drive", mode="w")
stamped.to_hdf(f"{out}/pandas_stamped.h5", "drive", mode="w")
frame.to_hdf(f"{out}/pandas_table.h5", "drive", mode="w", format="table", index=False, complevel=5, complib="zlib")
stamped.to_hdf(f"{out}/pandas_columns.h5", "drive", mode="w", format="table", data_columns=True, index=False, complevel=5)
truths = frame[["v"]].assign(brake=[True, False, False, True])
truths.to_hdf(f"{out}/pandas_truths_fixed.h5", "drive", mode="w")
truths.to_hdf(f"{out}/pandas_truths_table.h5", "drive", mode="w", format="table", index=False, complevel=5)
truths.to_hdf(f"{out}/pandas_truths_columns.h5", "drive", mode="w", format="table", data_columns=True, index=False,
              complevel=5)
numbers.to_hdf(f"{out}/pandas_blosc.h5", "drive", mode="w", format="table", index=False, complevel=5, complib="blosc")
