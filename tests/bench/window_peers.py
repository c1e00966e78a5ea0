#!/usr/bin/env python3
"""Window fits by Debian's Python packages on the trajectory that compare_windows writes; CPU time in ns per window, medians of 3."""
import sys
import time

try:
    import numpy as np
    import scipy.optimize
    from statsmodels.regression.rolling import RollingOLS
except ImportError as missing:
    sys.exit(f"window_peers.py: {missing}: install python3-scipy and python3-statsmodels to compare with them")

LENGTH, SCALE, WINDOWS = 25, 0.1, 50
data = np.fromfile(sys.argv[1]).reshape(-1, 3)[:20000]
X, y = data[:-1], np.diff(data[:, 0])


def rolling_ols():
    fit = RollingOLS(y, X, window=LENGTH).fit()
    check = np.linalg.lstsq(X[:LENGTH], y[:LENGTH], rcond=None)[0]
    assert np.allclose(np.asarray(fit.params)[LENGTH - 1], check, atol=1e-8)
    return len(y) - LENGTH + 1


def least_squares_huber():
    for k in range(WINDOWS):
        A, b = X[k:k + LENGTH], y[k:k + LENGTH]
        fit = scipy.optimize.least_squares(lambda p: A @ p - b, np.zeros(3), jac=lambda p: A.copy(), loss="huber", f_scale=SCALE,
                                           ftol=1e-10, xtol=1e-10, gtol=1e-10)
        assert fit.success
    return WINDOWS


for name, run in (("statsmodels RollingOLS (trivial)", rolling_ols), ("scipy least_squares (huber)", least_squares_huber)):
    times = []
    for _ in range(3):
        start = time.process_time()
        windows = run()
        times.append((time.process_time() - start) / windows)
    print(f"  {name:<34} {np.median(times) * 1e9:12.0f} ns/window")
