#!/usr/bin/env python3
"""Evaluates an exported module's functions: evaluate_casadi.py MODULE X U MU (lists of JSON); prints JSON. Uses CasADi
if it is installed, else casadi_stub, and prints which."""
import importlib.util
import json
import pathlib
import sys

try:
    import casadi

    by = "casadi"
except ImportError:
    sys.path.append(str(pathlib.Path(__file__).parent / "casadi_stub"))
    import casadi

    by = "stub"
import numpy as np

spec = importlib.util.spec_from_file_location("bank", sys.argv[1])
bank = importlib.util.module_from_spec(spec)
spec.loader.exec_module(bank)
point = [json.loads(argument) for argument in sys.argv[2:5]]


def lists(values):
    return [np.asarray(value, float).tolist() for value in values]


if by == "casadi":  # CasADi's derivatives
    x, u, mu = bank._symbols()
    slopes = [casadi.jacobian(bank.step(x, u, mu)[0], variable) for variable in (x, u)]
    exact = casadi.Function("exact", [x, u, mu], slopes)(*point)
    for own, by_casadi in zip(bank.linearised_function()(*point), exact):
        assert np.allclose(np.asarray(own, float), np.asarray(by_casadi, float), rtol=0, atol=1e-12)
print(json.dumps({"by": by, "step": lists(bank.step_function()(*point)), "linearised": lists(bank.linearised_function()(*point)),
                  "dt_s": bank.DT_S, "states": bank.STATES, "verdict": bank.VERDICT}))
