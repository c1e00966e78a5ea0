// Compares window fits with those of other programs. The programs run on one thread in alternating order. Prints
// medians of their CPU times over the rounds. modebank computes its full results: robust scale, prior, rank, condition,
// information and R^2. The peers have a fixed scale and no prior; they compute theta, `model` covariance and
// status. Usage: compare_windows [ROUNDS]
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>

#include "ident/base/seed.hpp"
#include "ident/fit/detail/batch/solver.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/motion_fit.hpp"
#include "modebank/ident/auto_diff_motion_model.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/window_peers.hpp"

namespace modebank::bench {
namespace {

constexpr Index samples = 1000000;
constexpr Index job = 1024;
constexpr double residual_scale = 0.1;
const LinearStructure structure{1, 2, false};

/// A run with regimes of 200 to 1000 samples, smooth commands and 2 % outliers, similar to that of the peers'
/// make_data.py.
Trajectory make_trajectory() {
  constexpr double regimes[6][3] = {{-.35, -.50, .50}, {-.60, -.80, .75}, {-.15, -.20, .25},
                                    {-.80, -1.2, 1.1}, {-.45, -.30, .60}, {-.25, -.70, .40}};
  auto generator = make_generator(1, "compare_windows");
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  Trajectory run;
  run.state.resize(1, samples);
  run.input.resize(2, samples);
  run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, 0.05 * static_cast<double>(samples - 1));
  double command[2] = {0, 0}, x = 0;
  Index left = 0;
  const double* theta = regimes[0];
  for (Index k = 0; k < samples; ++k) {
    if (left-- <= 0) {
      left = 200 + static_cast<Index>(generator() % 800);
      theta = regimes[generator() % 6];
    }
    for (int c = 0; c < 2; ++c) {
      command[c] = 0.95 * command[c] + 0.31 * normal(generator);
      run.input(c, k) = command[c] + 0.25 * normal(generator);
    }
    run.state(0, k) = x;
    x += theta[0] * x + theta[1] * run.input(0, k) + theta[2] * run.input(1, k) + 0.03 * normal(generator);
  }
  for (Index k = 0; k < samples; ++k)
    if (uniform(generator) < 0.02)
      run.state(0, k) += (uniform(generator) < 0.5 ? -1 : 1) * (0.5 + 2.5 * uniform(generator));
  return run;
}

PeerData peer_data(const Trajectory& run) {
  PeerData data;
  for (Index k = 0; k + 1 < samples; ++k) {
    data.x.push_back(run.state(0, k));
    data.left.push_back(run.input(0, k));
    data.right.push_back(run.input(1, k));
    data.increment.push_back(run.state(0, k + 1) - run.state(0, k));
  }
  return data;
}

/// The window problem that the peers solve.
FitOptions peer_options(Loss loss) {
  FitOptions options;
  options.loss = loss;
  options.sigma = residual_scale / default_loss_scale(loss);
  options.prior = Prior::none;
  return options;
}

/// Results of a job; the next job reuses the memory.
struct JobResults {
  Eigen::MatrixXd theta{3, job}, covariance{9, job}, information{3, job};
  Eigen::VectorXd noise{job}, condition{job}, inliers{job}, r_squared{job};
  Eigen::VectorXi rank{job}, status{job}, transitions{job};
  std::vector<batch::Verdict> verdict = std::vector<batch::Verdict>(job);
};

/// Fits all windows job by job, including the copying of samples. `consume` gets the results of each job.
void run_batch(const Trajectory& run, const BatchSolver& solver, Index windows,
               const std::function<void(Index, Index, const JobResults&)>& consume) {
  static BatchWorkspace workspace;
  static JobResults results;
  const batch::Output out{.verdict = results.verdict.data(),
                          .theta = results.theta.data(),
                          .covariance = results.covariance.data(),
                          .noise_variance = results.noise.data(),
                          .condition = results.condition.data(),
                          .information = results.information.data(),
                          .inlier_fraction = results.inliers.data(),
                          .r_squared = results.r_squared.data(),
                          .transitions = results.transitions.data(),
                          .rank = results.rank.data(),
                          .status = results.status.data()};
  for (Index first = 0; first < windows; first += job) {
    const Index count = std::min(job, windows - first);
    const batch::Chunk chunk = workspace.stage(run, first, count, structure, solver.settings());
    solver(chunk, workspace.scratch(peer_length), out);
    if (consume) consume(first, count, results);
  }
}

struct Entry {
  std::string name;
  Index windows;
  std::function<void()> run;
  std::vector<double> ns;
  double median() {
    std::sort(ns.begin(), ns.end());
    return ns[ns.size() / 2];
  }
};

/// CPU time of this program's single thread. Other programs are not measured.
double cpu_time_ns() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

void measure(std::vector<Entry>& entries, int rounds) {
  for (int round = 0; round < rounds; ++round)
    for (Entry& entry : entries) {
      const double start = cpu_time_ns();
      entry.run();
      entry.ns.push_back((cpu_time_ns() - start) / static_cast<double>(entry.windows));
    }
}

/// x[k+1] = x + A x + B u in the form of a user's own motion model.
struct PlainModel {
  template <class T>
  void operator()(const T* theta, const T* x, const T* u, double, T* next) const {
    next[0] = x[0] + theta[0] * x[0] + theta[1] * u[0] + theta[2] * u[1];
  }
};

/// Fits the first windows as a motion model. The search starts from parameters that fit none of the regimes.
void run_general(const Trajectory& run, Loss loss, Index windows, Eigen::MatrixXd& theta) {
  const auto model = make_auto_diff_model<1, 2, 3>(PlainModel(), "plain", {{"A", ""}, {"B1", ""}, {"B2", ""}});
  const ModelEstimator estimator = make_model_estimator(*model, peer_options(loss));
  const Eigen::VectorXd sigma = Eigen::VectorXd::Constant(1, residual_scale / default_loss_scale(loss));
  for (Index i = 0; i < windows; ++i) {
    const ModelResiduals residuals(*model, {{&run, i, peer_length}});
    theta.col(i) =
        fit_model(residuals, estimator, sigma, Eigen::VectorXd::Zero(1), nullptr, Eigen::Vector3d(-0.4, -0.6, 0.6))
            .theta;
  }
}

/// Compares theta of the first windows with that of naive Ceres. Naive Ceres stops within 1e-3 of the optimum at worst,
/// and usually within 1e-5.
void check_against(const std::vector<PeerFit>& peers, const Trajectory& run, const BatchSolver& solver) {
  Index near = 0, solved = 0;
  const Index windows = static_cast<Index>(peers.size());
  run_batch(run, solver, windows, [&](Index first, Index count, const JobResults& results) {
    for (Index i = 0; i < count; ++i) {
      solved += results.verdict[i] == batch::Verdict::solved ? 1 : 0;
      const Eigen::Map<const Eigen::Vector3d> peer(peers[first + i].theta);
      near += (results.theta.col(i) - peer).cwiseAbs().maxCoeff() < 1e-5 ? 1 : 0;
    }
  });
  check(solved == windows, fmt::format("{} of {} windows solved", solved, windows));
  check(near > windows * 98 / 100, fmt::format("{} of {} windows near Ceres' optimum", near, windows));
}

void compare(const Trajectory& run, const PeerData& data, Loss loss, int rounds) {
  const Index all = samples - peer_length - 1, naive = 1000, tiny = 20000, general = 5000;
  Eigen::MatrixXd general_theta(3, general);
  std::vector<PeerFit> naive_fits(naive), tiny_fits(tiny);
  const BatchSolver same_problem(batch_settings(structure, peer_options(loss), nullptr, 0.0));
  const ParameterPrior prior{Eigen::Vector3d(-0.4, -0.6, 0.6), Eigen::Vector3d::Constant(1.0)};
  FitOptions defaults;
  defaults.loss = loss;
  const BatchSolver full(batch_settings(structure, defaults, &prior, 1e-4));
  std::vector<Entry> entries{
      {"naive Ceres", naive, [&] { fit_naive_ceres(data, loss, residual_scale, naive, naive_fits.data()); }, {}},
      {"ceres::TinySolver, warm",
       tiny,
       [&] { fit_tiny_solver(data, loss, residual_scale, tiny, tiny_fits.data()); },
       {}},
      {"motion model by Ceres", general, [&] { run_general(run, loss, general, general_theta); }, {}},
      {"batch, full default path", all, [&] { run_batch(run, full, all, nullptr); }, {}}};
  measure(entries, rounds);
  check_against(naive_fits, run, same_problem);
  Index near = 0;
  for (Index i = 0; i < naive; ++i)
    near += (general_theta.col(i) - Eigen::Map<const Eigen::Vector3d>(naive_fits[i].theta)).cwiseAbs().maxCoeff() < 1e-5
                ? 1
                : 0;
  check(near > naive * 98 / 100, fmt::format("motion model: {} of {} windows near Ceres' optimum", near, naive));
  const double ns = entries[3].median();
  fmt::print("{}\n", name_of(loss));
  for (Entry& entry : entries)
    fmt::print("  {:<28} {:>10.1f} ns/window  {:>8.2f} x the batch\n", entry.name, entry.median(), entry.median() / ns);
}

/// Compares the time of fit_windows on two threads with that on one thread, best of 5. Writes the file that the Python
/// peers read.
void compare_threads(const Trajectory& run) {
  Recording recording;
  recording.states = {{"x", ""}};
  recording.inputs = {{"left", ""}, {"right", ""}};
  recording.runs = {run};
  double best[2] = {1e300, 1e300};
  for (int round = 0; round < 5; ++round)
    for (int threads = 1; threads <= 2; ++threads) {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
      const auto start = std::chrono::steady_clock::now();
      const WindowFits fits = fit_windows(recording, {});
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
      check(fits.count() == samples - peer_length, "fit_windows");
      best[threads - 1] = std::min(best[threads - 1], time.count());
    }
  fmt::print("fit_windows, all of it, {} windows: {:.3f} s on one thread, {:.3f} s on two: {:.2f} x\n",
             samples - peer_length, best[0], best[1], best[0] / best[1]);
}

}  // namespace
}  // namespace modebank::bench

int main(int argc, char** argv) {
  using namespace modebank;
  using namespace modebank::bench;
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
  const Trajectory run = make_trajectory();
  const PeerData data = peer_data(run);
  {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    for (const Loss loss : {Loss::trivial, Loss::huber, Loss::cauchy, Loss::softlone}) compare(run, data, loss, rounds);
  }
  compare_threads(run);
  return 0;
}
