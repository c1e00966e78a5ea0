#!/usr/bin/python3
"""Writes MATLAB files that hold objects: tests/golden/data/mat_*.mat. Needs scipy, which writes no object of MATLAB's
own class system: that one is put together from its parts (flags, name, "MCOS", class, an empty array).

Usage: mat_objects.py tests/golden/data
"""
import struct
import sys

import numpy as np
import scipy.io
from scipy.io.matlab import MatlabObject

out = sys.argv[1]


def cell(*values):
    cells = np.empty((1, len(values)), object)
    for k, value in enumerate(values):
        cells[0, k] = value
    return cells


def iddata(**fields):
    record = np.empty((1, 1), [(name, object) for name in fields])
    for name, value in fields.items():
        record[name][0, 0] = value
    return MatlabObject(record, "iddata")


k = np.arange(20.0)[:, None]
one = iddata(OutputData=cell(k), OutputName=cell("speed"), OutputUnit=cell("m/s"), InputData=cell(2 * k),
             InputName=cell("throttle"), InputUnit=cell("V"), Ts=cell(0.1), ExperimentName=cell("Exp1"))
two = iddata(OutputData=cell(np.hstack([k, k + 1]), 3 * k[:15] + [[0, 1]]), OutputName=cell("speed", "level"),
             OutputUnit=cell("m/s", "m"), InputData=cell(2 * k, 4 * k[:15]), InputName=cell("throttle"),
             InputUnit=cell("V"), Ts=cell(0.1, 0.2), ExperimentName=cell("Exp1", "Exp2"))
scipy.io.savemat(f"{out}/mat_iddata.mat", {"z": one})
scipy.io.savemat(f"{out}/mat_iddata_and_t.mat", {"z": one, "t": 0.1 * k})
scipy.io.savemat(f"{out}/mat_iddata_two.mat", {"z": two})


def element(kind, content):
    return struct.pack("<II", kind, len(content)) + content + bytes(-len(content) % 8)


opaque = element(6, struct.pack("<II", 17, 0)) + b"".join(element(1, text) for text in (b"z", b"MCOS", b"table"))
opaque += element(14, element(6, struct.pack("<II", 13, 0)) + element(5, struct.pack("<ii", 0, 0)) + element(1, b"")
                  + element(6, b""))
header = b"MATLAB 5.0 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x01IM"
open(f"{out}/mat_table.mat", "wb").write(header + element(14, opaque))
