#!/usr/bin/env python3
"""EM of Gaussian mixtures: modebank and Armadillo (build/compare_em) compared with scikit-learn.

All programs have the same start, a fixed number of iterations and one thread, and run in turn. Prints medians of CPU time
over the rounds; a busy machine disturbs CPU time less than wall time.

Then compares the whole study K = 1..25 with 5 restarts on 3000 points, also on two threads (wall time). Both programs start
from points drawn as centres, with full or diagonal covariance and without split-and-merge moves. They stop when the mean
log-likelihood gains less than 1e-3 (scikit-learn's default), or after 100 iterations. Every round has other seeds. Prints the
mean over the rounds of the sum of the log-likelihoods.

Usage: em_peers.py build/compare_em [ROUNDS [FIRST_LETTERS_OF_CASES]]; run it with OMP_NUM_THREADS=1
OPENBLAS_NUM_THREADS=1. Exits quietly if scikit-learn is not installed. Fails if log-likelihoods differ by more than
1e-11."""
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import warnings

try:
    import numpy as np
    from sklearn.mixture import GaussianMixture
    from sklearn.mixture._gaussian_mixture import _compute_precision_cholesky
except ImportError:
    sys.exit("em_peers.py: scikit-learn is not installed; nothing compared")

warnings.filterwarnings("ignore")
SAME = 1e-11


class FromStart(GaussianMixture):
    """EM iterations from given parameters."""

    def _initialize_parameters(self, X, random_state):
        pass

    def _initialize(self, X, resp):
        pass


def read_case(path):
    with open(path, "rb") as file:
        N, F, K, iterations = np.fromfile(file, "<i8", 4)
        points = np.fromfile(file, float, N * F).reshape(N, F)
        return points, int(iterations), np.fromfile(file, float, K), np.fromfile(file, float, K * F).reshape(K, F), \
            np.fromfile(file, float, K * F * F).reshape(K, F, F)


def run_sklearn(case, kind):
    points, iterations, weights, means, covariances = case
    model = FromStart(len(weights), covariance_type=kind, tol=0, reg_covar=0, max_iter=iterations)
    model.weights_, model.means_ = weights.copy(), means.copy()
    model.covariances_ = covariances.copy() if kind == "full" else np.array([np.diag(c) for c in covariances])
    model.precisions_cholesky_ = _compute_precision_cholesky(model.covariances_, kind)
    start = time.process_time()
    for _ in range(iterations):  # the estimator's own E and M steps
        _, log_responsibilities = model._e_step(points)
        model._m_step(points, log_responsibilities)
    return time.process_time() - start, model.score(points) * len(points)


class Server:
    def __init__(self, program, folder):
        self.process = subprocess.Popen([program, "serve", folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.cases = self.process.stdout.readline().split()

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return [float(word) for word in self.process.stdout.readline().split()]


def compare(server, folder, name, rounds):
    case = read_case(pathlib.Path(folder) / (name + ".bin"))
    kind = "full" if name.endswith("full") else "diag"
    own, armadillo, sklearn, differences = [], [], [], []
    for _ in range(rounds):
        seconds, log_likelihood, peer_seconds, peer_log_likelihood = server.ask("case " + name)
        own.append(seconds)
        if peer_seconds > 0:
            armadillo.append(peer_seconds)
            differences.append(abs(log_likelihood / peer_log_likelihood - 1))
        seconds, peer_log_likelihood = run_sklearn(case, kind)
        sklearn.append(seconds)
        differences.append(abs(log_likelihood / peer_log_likelihood - 1))
    base, iterations = statistics.median(own), case[1]
    text = f"{name:<24} modebank {base / iterations * 1e3:9.4f} ms/iteration"
    for label, times in (("Armadillo", armadillo), ("scikit-learn", sklearn)):
        if times:
            text += f"   {label} {statistics.median(times) / iterations * 1e3:9.3f} ms = {statistics.median(times) / base:6.1f} x"
    print(text + f"   log-likelihoods within {max(differences):.1e}", flush=True)
    if max(differences) > SAME:
        sys.exit(f"{name}: log-likelihoods differ")


def sweep(server, folder, kind, rounds):
    name = "3000,3,8," + kind
    points = read_case(pathlib.Path(folder) / (name + ".bin"))[0]
    short = "full" if kind == "full" else "diag"
    own, two, peer, ours, theirs = [], [], [], [], []
    for seed in range(1, rounds + 1):
        answer = server.ask(f"sweep {name} 1 25 5 {seed}")
        own.append(answer[0])
        ours.append(answer[1])
        two.append(server.ask(f"sweep {name} 2 25 5 {seed}")[0])
        start = time.process_time()
        fits = [GaussianMixture(k, covariance_type=short, n_init=5, init_params="random_from_data",
                                random_state=seed).fit(points) for k in range(1, 26)]
        peer.append(time.process_time() - start)
        theirs.append(sum(fit.score(points) * len(points) for fit in fits))
    print(f"K = 1..25, 5 restarts, {kind:<9} modebank {statistics.median(own):.3f} s, two threads {statistics.median(two):.3f} s"
          f" (wall); scikit-learn {statistics.median(peer):.2f} s = {statistics.median(peer) / statistics.median(own):.0f} x, "
          f"{statistics.median(peer) / statistics.median(two):.0f} x; sums of log-likelihoods {statistics.mean(ours):.0f} and {statistics.mean(theirs):.0f}",
          flush=True)


def main():
    program, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 3
    first = sys.argv[3] if len(sys.argv) > 3 else ""
    with tempfile.TemporaryDirectory() as folder:
        server = Server(program, folder)
        for name in server.cases:
            if name.startswith(first):
                compare(server, folder, name, rounds)
        for kind in ("full", "diagonal"):
            if not first or first == "sweep":
                sweep(server, folder, kind, rounds)


main()
