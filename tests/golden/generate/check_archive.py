#!/usr/bin/env python3
"""Reads an archive as a user of h5py does and checks it against the contract.

    /usr/bin/python3 tests/golden/generate/check_archive.py ARCHIVE.h5

ARCHIVE.h5 is full_archive(2, 1) of tests/io/archive/archive_fixture.cpp (n = 2 states, m = 1 input, intercept, K = 3 modes,
M = 9 windows, runs of 12, 13 and 14 samples), whose entries follow the formulas stated here a second time. Exit status
0 and no output when everything is as the contract says; else the list of differences and 1.
"""
import hashlib
import sys

import h5py
import numpy as np

n, m, n_y, K, M = 2, 1, 2, 3, 9
p = n * (n + m + 1)
F = p + 1
RUNS = {"run 2": 12, "Gelände.ä": 13, "10": 14}
STATE_UNITS = [b"rad/s", b"m/s"]
PARAMETER_UNITS = [b"1", b"(rad/s)/(m/s)", b"(rad/s)/(m/s)", b"rad/s", b"(m/s)/(rad/s)", b"1", b"1", b"m/s"]
LABELS = np.array([b"x0 <- x0", b"x0 <- x1", b"x0 <- u0", b"x0 <- 1", b"x1 <- x0", b"x1 <- x1", b"x1 <- u0", b"x1 <- 1"])
problems = []


def expect(what, actual, expected):
    same = np.array_equal(actual, expected)
    if not same:
        problems.append(f"{what}: {actual!r}, expected {expected!r}")


def expect_array(item, shape, dtype, units=None):
    expect(f"{item.name} shape", item.shape, shape)
    expect(f"{item.name} dtype", item.dtype.str, dtype)
    if units is None:
        expect(f"{item.name} has units", "units" in item.attrs, False)
    elif "units" not in item.attrs:
        problems.append(f"{item.name} has no units")
    else:
        expect(f"{item.name} units", np.asarray(item.attrs["units"]), np.asarray(units))


def pattern(count, entries, base):
    """Entry i of sample s is base + 100 s + i + 1/3."""
    s, i = np.meshgrid(np.arange(count), np.arange(entries), indexing="ij")
    return base + 100.0 * s + i + 1.0 / 3.0


def spread(count, side, base):
    """Symmetric matrices whose upper halves are the pattern's."""
    upper = np.triu(pattern(count, side * side, base).reshape(count, side, side))
    return upper + np.triu(upper, 1).swapaxes(1, 2)


def probabilities(count, entries, base):
    """The pattern over 10^4, but for the last entry, which makes the sum 1."""
    result = pattern(count, entries, base) / 1e4
    result[:, -1] = 1.0 - result[:, :-1].sum(axis=1)
    return result


def product(a, b):
    if b"1" in (a, b):
        return b if a == b"1" else a
    return b"(" + a + b")^2" if a == b else b"(" + a + b")*(" + b + b")"


def outer(units):
    return [[product(a, b) for b in units] for a in units]


def check_strings(item, what, encodings=("utf-8",)):
    info = h5py.check_string_dtype(item.dtype)
    expect(f"{what} is a fixed-length UTF-8 string", info is not None and info.encoding in encodings, True)
    expect(f"{what} has a length", info.length is not None, True)


def check_user_block(path):
    with open(path, "rb") as file:
        content = file.read()
    expect("user block hash", content[:64].decode(), hashlib.sha256(content[512:]).hexdigest())
    expect("user block rest", content[64:512], bytes(448))


def check_root(file):
    expect("user block size", file.userblock_size, 512)
    expect("format", file.attrs["format"], b"modebank")
    expect("schema_version", file.attrs["schema_version"], b"4.0")
    expect("modebank_version", file.attrs["modebank_version"], b"0.1.0")
    expect("created", file.attrs["created"], b"2026-08-01T12:00:00Z")
    expect("command_line", file.attrs["command_line"], b'modebank run "a b.ini" --window.length 5')
    expect("config_hash", file.attrs["config_hash"], b"c" * 64)
    expect("data_hash", file.attrs["data_hash"], b"d" * 64)
    expect("root members", sorted(file), sorted(
        ["config", "provenance", "data", "lag", "windows", "mixture", "bank", "baseline", "noise_only", "one_motion", "drifting", "evaluation",
         "residual_tests"]))
    check_strings(file["config"], "config")
    expect("config", file["config"][()].decode(), "[window]\nlength = 5  # fünf\n")
    expect("Ceres", file["provenance"].attrs["Ceres"], b"2.1.0")
    inputs = file["provenance/inputs"]
    expect("inputs columns", inputs.dtype.names, ("path", "bytes", "sha256"))
    expect("inputs bytes", inputs["bytes"], np.array([9007199254740993, 12], np.uint64))
    expect("inputs path", inputs["path"][1].decode(), "/data/Gelände.csv")
    expect("inputs sha256", inputs["sha256"][0], b"1" * 64)


def rows_of_runs(file):
    """The rows of each run in arrays over samples."""
    table = file["data/runs"]
    return {row["name"].decode(): slice(row["first"], row["first"] + row["samples"]) for row in table}


def check_data(file):
    group, S = file["data"], sum(RUNS.values())
    table = group["runs"]
    expect("runs columns", table.dtype.names, ("name", "role", "first", "samples", "lag_s", "time_origin_ns", "file"))
    expect("runs", [name.decode() for name in table["name"]], list(RUNS))
    expect("first rows", table["first"], np.array([0, 12, 25]))
    expect("samples", table["samples"], np.array(list(RUNS.values())))
    expect("roles", table["role"], np.array([b"train", b"test", b"train"]))
    expect("lag_s", table["lag_s"], 0.1 * np.arange(3))
    expect("origin", table["time_origin_ns"], np.full(3, 1714557600000000001))
    expect("file", table["file"], np.array([b"/data/pro_00.csv", b"", b""]))
    expect("arrays", sorted(group), ["input", "label", "runs", "state", "time", "truth"])
    expect_array(group["time"], (S,), "<f8", b"s")
    expect_array(group["state"], (S, n), "<f8", STATE_UNITS)
    expect_array(group["input"], (S, m), "<f8", b"m/s")
    expect_array(group["truth"], (S, n), "<f8", STATE_UNITS)
    expect_array(group["label"], (S,), "<i4")
    expect("no truth", np.isnan(group["truth"].fillvalue), True)
    expect("no label", group["label"].fillvalue, -1)
    for position, (run, rows) in enumerate(rows_of_runs(file).items()):
        N = RUNS[run]
        state = pattern(N, n, 1000.0 * position)
        if position == 0:
            state[3, 0] = np.nan
        expect(f"{run} state bits", group["state"][rows].tobytes(), state.tobytes())
        expect(f"{run} input", group["input"][rows], pattern(N, m, 0.0))
        expect(f"{run} time", group["time"][rows], np.linspace(0.1, 3.0, N))
        if position == 2:
            expect(f"{run} has no truth", np.isnan(group["truth"][rows]).all(), True)
        else:
            expect(f"{run} truth", group["truth"][rows], pattern(N, n, 7.0))


def check_lag(file):
    group = file["lag"]
    expect("correction", group.attrs["correction"], b"pooled")
    expect("pooled lag", group.attrs["lag_s"], 0.25)
    runs = group["runs"]
    expect("lag runs", [name.decode() for name in runs["run"]], ["run 2", "Gelände.ä", "10"])
    expect("lag status", list(runs["status"]), [b"at_edge", b"not_estimated", b"at_edge"])
    expect("lag applied", runs["applied_lag_s"], np.array([0.0, 0.1, 0.2]))
    expect("lag units", dict(zip(runs.dtype.names, runs.attrs["units"]))["lag_s"], b"s")
    expect("lag scores", list(group["scores"]["correction"]), [b"none", b"pooled"])


def check_windows(file):
    group = file["windows"]
    expect("length", group.attrs["length"], 5)
    expect("step", group.attrs["step"], 2)
    expect("loss", group.attrs["loss"], b"tukey")
    expect("model", group.attrs["model"], b"linear")
    expect("parameter_names", group.attrs["parameter_names"],
           np.array([b"A11", b"A12", b"B11", b"c1", b"A21", b"A22", b"B21", b"c2"]))
    expect("parameter_labels", group.attrs["parameter_labels"], LABELS)
    check_strings(group["run"], "run", ("utf-8", "ascii"))  # ASCII is valid UTF-8, and Octave reads only ASCII
    expect("run", [name.decode() for name in group["run"]], ["10" if i % 3 == 2 else "run 2" for i in range(M)])
    expect_array(group["start"], (M,), "<i8")
    expect("start", group["start"][()], np.arange(M) % 7)
    expect_array(group["parameters"], (M, p), "<f8", PARAMETER_UNITS)
    expect_array(group["covariance"], (M, p, p), "<f8", outer(PARAMETER_UNITS))
    expect_array(group["noise_variance"], (M, n), "<f8", [b"(rad/s)^2", b"(m/s)^2"])
    expect_array(group["condition"], (M,), "<f8")
    expect_array(group["rank"], (M,), "<i4")
    expect_array(group["information"], (M, p), "<f8")
    expect_array(group["inlier_fraction"], (M,), "<f8")
    expect_array(group["status"], (M,), "<i4")
    expect_array(group["standard_error"], (M, p), "<f8", PARAMETER_UNITS)
    expect_array(group["t_value"], (M, p), "<f8")
    expect_array(group["r_squared"], (M, n), "<f8")
    expect_array(group["transitions"], (M,), "<i4")
    error = np.sqrt(np.diagonal(pattern(M, p * p, 2.0).reshape(M, p, p), axis1=1, axis2=2))
    expect("standard_error", group["standard_error"][()], error)
    expect("t_value", group["t_value"][()], pattern(M, p, 1.0) / error)
    expect("parameters", group["parameters"][()], pattern(M, p, 1.0))
    expect("covariance", group["covariance"][()], spread(M, p, 2.0))
    expect("rank", group["rank"][()], np.arange(1, M + 1) % (p + 1))
    expect("condition", group["condition"][2], np.inf)
    expect_array(group["global/parameters"], (p,), "<f8", PARAMETER_UNITS)
    expect_array(group["global/covariance"], (p, p), "<f8", outer(PARAMETER_UNITS))
    expect_array(group["global/noise_variance"], (n,), "<f8", [b"(rad/s)^2", b"(m/s)^2"])
    expect("global noise_variance", group["global/noise_variance"][()], np.diag(pattern(n, n, 11.0)))


def check_mixture(file):
    group = file["mixture"]
    table = group["candidates"]
    expect("candidates columns", table.dtype.names,
           ("components", "covariance", "log_likelihood", "parameters", "effective_samples", "bic", "aic",
            "iterations", "converged", "agreeing_restarts", "selected", "bic_naive", "restarts",
            "floor_active", "status", "failed"))
    expect("status", table["status"], np.array([b"fitted", b"failed"]))
    expect("failed", table["failed"], np.array([b"", b"its covariance is singular"]))
    expect("converged dtype", table.dtype["converged"].str, "|i1")
    expect("selected", table["selected"], np.array([0, 1]))
    expect("covariance", table["covariance"], np.array([b"full", b"diagonal"]))
    expect("components", table["components"], np.array([2, 3]))
    expect_array(group["weights"], (K,), "<f8")
    expect_array(group["means"], (K, F), "<f8", PARAMETER_UNITS + [b"1"])
    expect_array(group["covariances"], (K, F, F), "<f8", outer(PARAMETER_UNITS + [b"1"]))
    expect_array(group["labels"], (M,), "<i4")
    expect_array(group["responsibilities"], (M, K), "<f8")
    expect("means", group["means"][()], pattern(K, F, 20.0))
    for k in range(K):  # base + 101 i + 1/3 on the diagonal, 1/3 elsewhere
        covariance = np.full((F, F), 1.0 / 3.0)
        np.fill_diagonal(covariance, 30.0 + k + 101.0 * np.arange(F) + 1.0 / 3.0)
        expect(f"covariances[{k}]", group["covariances"][k], covariance)
    expect("labels", group["labels"][()], np.array([0, 2, 1, -1, -1, -1, -1, -1, -1]))
    expect("responsibilities", group["responsibilities"][:3], pattern(3, K, 40.0) / 1e4)
    expect("responsibilities", np.isnan(group["responsibilities"][3:]).all(), True)
    expect("feature_names", group.attrs["feature_names"][-1], b"log_noise_variance_x0")


def check_bank(group, modes, uncertain):
    name = group.name
    expect(f"{name} model", group.attrs["model"], b"linear")
    expect(f"{name} form", group.attrs["form"], b"increment")
    expect(f"{name} state_names", group.attrs["state_names"], np.array([b"x0", b"x1"]))
    expect(f"{name} input_names", group.attrs["input_names"], np.array([b"u0"]))
    expect(f"{name} parameter_labels", group.attrs["parameter_labels"], LABELS)
    expect(f"{name} dt_s", group.attrs["dt_s"], 2.0 / 13.0)
    ratios = [[b"1", b"(rad/s)/(m/s)"], [b"(m/s)/(rad/s)", b"1"]]
    expect_array(group["A"], (modes, n, n), "<f8", ratios)
    expect_array(group["B"], (modes, n, m), "<f8", [[b"(rad/s)/(m/s)"], [b"1"]])
    expect_array(group["c"], (modes, n), "<f8", STATE_UNITS)
    expect_array(group["Q"], (modes, n, n), "<f8", outer(STATE_UNITS))
    expect_array(group["weight"], (modes,), "<f8")
    expect_array(group["parameters"], (modes, p), "<f8", PARAMETER_UNITS)
    expect_array(group["C"], (n_y, n), "<f8", ratios)
    expect_array(group["R"], (n_y, n_y), "<f8", outer(STATE_UNITS))
    expect_array(group["transition"], (modes, modes), "<f8")
    expect_array(group["initial_probability"], (modes,), "<f8")
    k, i, j = np.meshgrid(np.arange(modes), np.arange(n), np.arange(n), indexing="ij")
    expect(f"{name} A[k][i][j]", group["A"][()], -0.1 - (k + (i + 2 * j) / 8.0) / 64.0)
    A, B, c = group["A"][()], group["B"][()], group["c"][()]
    theta = np.concatenate([A, B, c[:, :, None]], axis=2).reshape(modes, p)
    expect(f"{name} parameters = row-major [A B c]", group["parameters"][()], theta)
    if modes == K:
        expect(f"{name} transition, row = from", group["transition"][()].round(12),
               np.array([[0.7, 0.2, 0.1], [0.05, 0.9, 0.05], [0.15, 0.25, 0.6]]))
    expect(f"{name} screened columns", group["screened"].dtype.names,
           ("component", "weight", "spectral_radius", "reason"))
    expect(f"{name} screened rows", len(group["screened"]), 1 if uncertain else 0)
    if uncertain:
        expect_array(group["parameter_covariance"], (modes, p, p), "<f8", outer(PARAMETER_UNITS))
        expect_array(group["parameter_standard_error"], (modes, p), "<f8", PARAMETER_UNITS)
        expect_array(group["Q_standard_error"], (modes, n, n), "<f8", outer(STATE_UNITS))
        expect_array(group["R_standard_error"], (n_y, n_y), "<f8", outer(STATE_UNITS))
        expect_array(group["transition_standard_error"], (modes, modes), "<f8")
        expect(f"{name} measured_fit", group.attrs["measured_fit"], b"iteration_limit")
        expect(f"{name} learned_transitions", group.attrs["learned_transitions"], 40)
        check_bank(group["unrefined"], 1, False)
        expect(f"{name} reason", group["screened"]["reason"][0], b"unstable: spectral radius 1.25")


def check_evaluation(file):
    S = sum(RUNS.values())
    for name, modes in (("bank", K), ("baseline", 1), ("noise_only", K), ("one_motion", K)):
        group = file["evaluation"][name]
        expect_array(group["prediction"], (S, n), "<f8", STATE_UNITS)
        expect_array(group["innovation"], (S, n_y), "<f8", STATE_UNITS)
        expect_array(group["innovation_covariance"], (S, n_y, n_y), "<f8", outer(STATE_UNITS))
        expect_array(group["state"], (S, n), "<f8", STATE_UNITS)
        expect_array(group["covariance"], (S, n, n), "<f8", outer(STATE_UNITS))
        expect_array(group["nis"], (S,), "<f8")
        expect_array(group["pit"], (S, n_y), "<f8")
        expect_array(group["log_density"], (S,), "<f8", b"nat")
        expect_array(group["mode_probability_predicted"], (S, modes), "<f8")
        expect_array(group["mode_probability"], (S, modes), "<f8")
        expect(f"{name} viterbi_mode", "viterbi_mode" in group, modes > 1)
        for which in ("mean", "sd", "lower", "upper"):
            expect_array(group[f"free_run_{which}"], (S, n), "<f8", STATE_UNITS)
        expect_array(group["free_run_mode"], (S,), "<i4")
        if modes > 1:
            expect_array(group["viterbi_mode"], (S,), "<i4")
        for run, rows in rows_of_runs(file).items():
            N = RUNS[run]
            expect(f"{name} {run} prediction", group["prediction"][rows], pattern(N, n, 70.0))
            expect(f"{name} {run} covariance", group["covariance"][rows], spread(N, n, 74.0))
            expect(f"{name} {run} mode_probability", group["mode_probability"][rows], probabilities(N, modes, 79.0))
            expect(f"{name} {run} nis[0]", np.isnan(group["nis"][rows.start]), True)
            expect(f"{name} {run} free_run_sd", group["free_run_sd"][rows], pattern(N, n, 61.0))
            if modes > 1:
                expect(f"{name} {run} viterbi_mode", group["viterbi_mode"][rows], np.arange(N) % (modes + 1) - 1)
    table = file["evaluation/summary"]
    expect("summary columns", table.dtype.names,
           ("filter", "role", "run", "samples", "log_score", "rmse", "nis_mean", "nis_above", "nis_below",
            "coverage_50", "coverage_90", "coverage_95", "coverage_99", "too_far", "too_close", "pit_distance", "whiteness_p"))
    expect("summary rmse", table["rmse"], np.array([[80.0 + 1.0 / 3.0, 81.0 + 1.0 / 3.0]] * 8))
    expect("summary filter", table["filter"], np.repeat([b"bank", b"baseline", b"noise_only", b"one_motion"], 2))
    expect("summary role", table["role"], np.array([b"train", b"test"] * 4))
    expect("summary run", table["run"], np.array([b"run 2", b"*"] * 4))
    expect("horizon columns", file["evaluation/horizon"].dtype.names,
           ("filter", "role", "run", "horizon", "samples", "log_score", "rmse",
            "coverage_95"))
    combination = file["evaluation/combination"]
    expect("combination columns", combination.dtype.names, ("role", "horizon", "filter", "weight", "start"))
    expect("combination weight", combination["weight"], np.array([0.75, 0.25]))
    free = file["evaluation/free_run"]
    expect("free run columns", free.dtype.names,
           ("filter", "role", "run", "start", "samples", "log_score", "rmse", "nrmse", "fit", "coverage_50", "coverage_90", "coverage_95",
            "coverage_99", "lost_paths"))
    expect("free run fit", free["fit"], np.array([[66.0 + 1.0 / 3.0, 67.0 + 1.0 / 3.0]] * 4))
    diagnostics = file["evaluation/diagnostics"]
    expect("diagnostics verdict", diagnostics["verdict"], np.array([b"overconfident"] * 4))
    expect("diagnostics reason", diagnostics["reason"], np.array([b"band"] * 4))
    expect("diagnostics flags", diagnostics["flags"], np.array([b"probabilities flat; heavy tails"] * 4))
    expect("diagnostics too_far_upper", diagnostics["too_far_upper"], np.array([0.06] * 4))
    expect("summary units", dict(zip(table.dtype.names, table.attrs["units"]))["rmse"], b"rad/s, m/s")


def check_evidence(group):
    expect("answer", group.attrs["answer"], b"no evidence")
    expect("best_competitor", group.attrs["best_competitor"], b"one_motion")
    expect("gain", group.attrs["gain"], -0.125)
    expect("standard_error", group.attrs["standard_error"], 0.0625)
    expect("runs", group.attrs["runs"], 3)
    expect("text", group.attrs["text"], b"3 held-out runs show no evidence for modes of motion.")
    gains = group["gains"]
    expect("gains", gains["competitor"], np.array([b"baseline", b"one_motion"]))
    expect("margin", gains["margin"], np.array([0.5, 0.125]))
    expect("better means", group["better_means"]["rmse"], np.array([0.25]))


def check_residual_tests(file):
    T, models = 4, [b"global", b"bank"]
    names = np.array([run.encode() for run in RUNS] * 2)
    table = file["residual_tests/runs"]
    expect("residual runs columns", table.dtype.names,
           ("model", "run", "samples", "level", "autocorrelation_band", "lags", "ljung_box_p", "cross_correlation_band"))
    expect("models", table["model"], np.repeat(models, 3))
    expect("residual runs", table["run"], names)
    expect("residual samples", table["samples"], np.array([10, 11, 12] * 2))
    expect("level", table["level"], np.full(6, 0.99))
    expect("band", table["autocorrelation_band"], np.full(6, 0.25))
    expect("lags", table["lags"], np.full(6, T))
    lags = file["residual_tests/lags"]
    expect("lags columns", lags.dtype.names, ("model", "run", "lag", "autocorrelation", "cross_correlation"))
    expect("model of a lag", lags["model"], np.repeat(models, 3 * T))
    expect("run of a lag", lags["run"], np.repeat(names, T))
    expect("lag", lags["lag"], np.tile(np.arange(T), 6))
    expect("autocorrelation", lags["autocorrelation"], np.concatenate([pattern(T, n, 90.0 + run) for run in (0, 1, 2)] * 2))
    expect("cross_correlation", lags["cross_correlation"], np.tile(pattern(T, n * m, 91.0), (6, 1)))


def main():
    check_user_block(sys.argv[1])
    with h5py.File(sys.argv[1], "r") as file:
        check_root(file)
        check_data(file)
        check_lag(file)
        check_windows(file)
        check_mixture(file)
        check_bank(file["bank"], K, True)
        check_bank(file["baseline"], 1, False)
        check_bank(file["noise_only"], K, False)
        check_bank(file["one_motion"], K, False)
        check_evaluation(file)
        check_evidence(file["evaluation/evidence"])
        check_residual_tests(file)
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
