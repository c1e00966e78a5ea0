"""Data of one experiment: the first part trains, the rest is held out, and both together are run free, beside ARX models by least squares."""
import numpy as np

from benchmark import Failed, filters, head, line, modes, rows, run, title_of

CONFIG = """[data]
inputs = {folder}/part_*.csv
state = y
input = u
time = time
quantum = {quantum}
train = a
test = b, whole
[window]
model = varx
state_lags = {na}
input_lags = {nb}
input_delay = {delay}
intercept = {intercept}
[filter]
simulate = {start}
simulate_start = fixed
"""


class Arx:
    """y[k] from y[k-1..k-na] and u[k-delay..k-delay-nb+1] by ordinary least squares; without an intercept, means of the training part are removed."""

    def __init__(self, na, nb, delay):
        self.na, self.nb, self.delay = na, nb, delay
        self.start = max(na, nb - 1 + delay)

    def regressor(self, u, y, k):
        return np.r_[y[k - self.na:k][::-1], u[k - self.delay - self.nb + 1:k - self.delay + 1][::-1]]

    def design(self, u, y, samples):
        return np.array([self.regressor(u, y, k) for k in samples])

    def fit(self, u, y):
        samples = np.arange(self.start, len(y))
        self.theta = np.linalg.lstsq(self.design(u, y, samples), y[samples], rcond=None)[0]
        self.variance = np.mean((y[samples] - self.design(u, y, samples) @ self.theta) ** 2)
        return self

    def one_step(self, u, y):
        return self.design(u, y, np.arange(self.start, len(y))) @ self.theta

    def free_run(self, u, y):
        """Free run: the first samples are measured, the rest follows from the inputs."""
        x = y.copy()
        for k in range(self.start, len(y)):
            x[k] = self.regressor(u, x, k) @ self.theta
        return x


def fit_percent(truth, predicted):
    return 100 * (1 - np.linalg.norm(truth - predicted) / np.linalg.norm(truth - truth.mean()))


def gaussian(errors, variance):
    return -0.5 * np.mean(np.log(2 * np.pi * variance) + errors ** 2 / variance)


def filter_rows(archive, held):
    """`held`: the samples of the held-out part that are scored."""
    for name in filters(archive):
        if not (one := rows(archive, "summary", filter=name, role="test", run="b")):
            continue
        if one[0]["samples"] != len(held):
            raise Failed(f"{one[0]['samples']} samples are scored, not {len(held)}")
        free = {r["run"]: float(np.atleast_1d(r["fit"])[0]) for r in rows(archive, "free_run", filter=name, role="test")}
        rmse = float(np.atleast_1d(one[0]["rmse"])[0])
        line(f"bank, {modes(archive)} mode(s)" if name == "bank" else title_of(name), f"{one[0]['log_score']:.3f}", f"{rmse:.5f}",
             f"{100 * (1 - rmse / held.std()):.2f}", f"{free['whole']:.2f}", f"{free['b']:.2f}")


def experiment(given, title, protocol, u, y, period_s, order, trains, intercept, reference, quantum="none"):
    """`order`: na, nb, delay. `trains`: number of training samples at the beginning."""
    arx = Arx(*order)
    for name, part in (("a", slice(0, trains)), ("b", slice(trains, None)), ("whole", slice(None))):
        table = np.c_[period_s * np.arange(len(y[part])), u[part], y[part]]
        np.savetxt(given.out / f"part_{name}.csv", table, "%.9g", ",", header="time,u,y", comments="")
    config = given.out / "experiment.ini"
    config.write_text(CONFIG.format(folder=given.out, na=order[0], nb=order[1], delay=order[2], intercept=str(intercept).lower(), quantum=quantum,
                                    start=arx.start), encoding="utf-8")
    head(given.program, title, protocol,
         ["predictor", "held-out part, one step: nats", "RMSE", "FIT %", "free run of all samples: FIT %", "of the held-out part: FIT %"])
    try:
        filter_rows(run(given.program, config, given.out / "experiment.h5"), y[trains + arx.start:])
    except Failed as error:
        line(f"the program fails: {error}", *[""] * 5)
    mean_u, mean_y = (u[:trains].mean(), y[:trains].mean()) if intercept else (0.0, 0.0)
    U, Y = u - mean_u, y - mean_y
    arx.fit(U[:trains], Y[:trains])
    errors = Y[trains + arx.start:] - arx.one_step(U[trains:], Y[trains:])
    line("ARX by least squares, computed here", f"{gaussian(errors, arx.variance):.3f}", f"{np.sqrt(np.mean(errors ** 2)):.5f}",
         f"{100 * (1 - np.sqrt(np.mean(errors ** 2)) / y[trains + arx.start:].std()):.2f}",
         f"{fit_percent(Y[arx.start:], arx.free_run(U, Y)[arx.start:]):.2f}",
         f"{fit_percent(Y[trains + arx.start:], arx.free_run(U[trains:], Y[trains:])[arx.start:]):.2f}")
    for row in reference:
        line(*row)
    print(f"\nscored one step ahead: {len(y) - trains - arx.start} samples of the held-out part")
