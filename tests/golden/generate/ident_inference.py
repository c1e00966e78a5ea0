"""Golden values of what a fit says of its quality, and of residual tests, by statsmodels.

Run from this folder:  /usr/bin/python3 ident_inference.py ../data/ident_inference.json > new.json

Needs numpy and statsmodels. Each case holds its data (state n x N, input m x N, or residual and input) beside the
expected values; the data are taken from the file. theta is the vec of [A B (c)] of the increment form.
"""

import json
import sys

import numpy as np
import statsmodels.api as sm
from statsmodels.stats.diagnostic import acorr_ljungbox
from statsmodels.tsa.stattools import acf, ccf

from ident_fits import regression


def ordinary_least_squares(case):
    X, Y = regression(np.array(case["state"]), np.array(case["input"]), 1)
    fits = [sm.OLS(Y[:, i], X).fit() for i in range(2)]
    return case | {
        "standard_error": np.concatenate([f.bse for f in fits]).tolist(),
        "t_value": np.concatenate([f.tvalues for f in fits]).tolist(),
        "r_squared": [f.rsquared for f in fits],  # with a constant it is about the mean
    }


def residual_tests(case):
    e, u, lags = np.array(case["residual"]), np.array(case["input"]), case["lags"]
    return case | {
        "autocorrelation": acf(e[0], nlags=lags, fft=False).tolist(),
        "cross_correlation": [ccf(e[0], u[j], adjusted=False)[: lags + 1].tolist() for j in range(2)],
        "ljung_box_p": float(acorr_ljungbox(e[0][:60], lags=[12])["lb_pvalue"].iloc[0]),
    }


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        cases = json.load(file)
    json.dump({f.__name__: f(cases[f.__name__]) for f in (ordinary_least_squares, residual_tests)}, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
