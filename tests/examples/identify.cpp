// From recorded runs to a filter in one program. It simulates a robot on grip and on ice, fits and clusters windows,
// and learns a bank. Then it steps the bank over a run that did not train.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <modebank/filter/bank_filter.hpp>
#include <modebank/ident/auto_diff_motion_model.hpp>
#include <modebank/ident/windows.hpp>
#include <modebank/learn/learn.hpp>
#include <modebank/mixture/mixture.hpp>
#include <random>
#include <vector>

#include "other_eigen.hpp"

namespace {

// Yaw rate x[k+1] = x + a x + b (right - left) + noise, with its a and b on grip and on ice.
struct Ground {
  double a, b;
};
constexpr Ground grounds[]{{-0.6, 0.5}, {-0.2, 0.1}};
constexpr int samples = 400, samples_per_ground = 100;

int ground_at(int k) { return k / samples_per_ground % 2; }

modebank::RecordedRun drive(unsigned seed, bool held_out) {
  std::mt19937 generator(seed);
  const auto uniform = [&] { return static_cast<double>(generator()) / 4294967296.0 - 0.5; };
  modebank::RecordedRun run;
  run.name = "drive " + std::to_string(seed);
  run.held_out = held_out;
  run.state = modebank::Matrix(1, samples);
  run.input = modebank::Matrix(2, samples);
  for (int k = 0; k < samples; ++k) {
    run.time_s.push_back(0.1 * k);
    run.input(0, k) = 2.0 * uniform();
    run.input(1, k) = 2.0 * uniform();
    if (k + 1 == samples) break;
    const Ground& ground = grounds[ground_at(k)];
    const double noise = 0.02 * (uniform() + uniform() + uniform());
    run.state(0, k + 1) =
        run.state(0, k) + ground.a * run.state(0, k) + ground.b * (run.input(1, k) - run.input(0, k)) + noise;
  }
  return run;
}

// A model of your own: one equation for any number type, with automatic derivatives. Here both wheels have the same
// gain.
struct YawModel {
  template <class T>
  void operator()(const T* theta, const T* x, const T* u, double, T* next) const {
    next[0] = x[0] + theta[0] * x[0] + theta[1] * (u[1] - u[0]);
  }
};

// Distance of the nearest column (A, B_left, B_right) of theta from a ground's true values.
double distance(const modebank::Matrix& theta, const Ground& truth) {
  double nearest = INFINITY;
  for (std::ptrdiff_t k = 0; k < theta.cols; ++k)
    nearest =
        std::min(nearest, std::hypot(theta(0, k) - truth.a, std::hypot(theta(1, k) + truth.b, theta(2, k) - truth.b)));
  return nearest;
}

}  // namespace

int main() try {
  const double before = other_eigen_sum();
  modebank::RecordedRuns runs{{}, {"yaw_rate"}, {"left", "right"}};
  for (unsigned seed = 1; seed <= 6; ++seed) runs.runs.push_back(drive(seed, seed == 6));

  // Step by step: a local model per window, then their clusters.
  modebank::LearnOptions options;
  options.window.length = 20;
  const modebank::ident::Windows windows = modebank::ident::fit_windows(runs, options.window);
  const modebank::AutoDiffMotionModel<YawModel, 1, 2, 2> yaw_model({}, "yaw", {{"decay", "1"}, {"gain", "rad/m"}});
  const modebank::ident::Windows by_yaw_model = modebank::ident::fit_windows(runs, options.window, yaw_model);
  std::printf("first window: linear model %s = %.3f, own model decay = %.3f\n", windows.parameter_names[0].c_str(),
              windows.theta(0, 0), by_yaw_model.theta(0, 0));
  modebank::mixture::Points points{windows.theta, {}, {}};
  points.effective_samples = static_cast<double>(windows.run.size()) / static_cast<double>(options.window.length);
  modebank::SelectionOptions few;
  few.components = {1, 2, 3, 4};  // windows over a change of ground may form their own component
  const modebank::mixture::Clusters clusters = modebank::mixture::select(points, few);
  std::printf("%zu windows, %zu clusters\n", windows.run.size(), clusters.mixture.weights.size());
  for (std::ptrdiff_t k = 0; k < clusters.mixture.means.cols; ++k)
    std::printf("cluster %td: %.2f of the windows about %s = %.3f\n", k, clusters.mixture.weights[k],
                windows.parameter_names[0].c_str(), clusters.mixture.means(0, k));

  // All at once, as in `modebank run`.
  options.mixture.selection.components = {1, 2, 3};
  options.bank.refine = modebank::Refine::em;
  const modebank::learn::Learned learned = modebank::learn::learn_bank(runs, options);
  const modebank::learn::Uncertainty& known = learned.uncertainty;
  for (std::ptrdiff_t k = 0; k < known.theta.cols; ++k)
    std::printf("mode %td: %s = %.3f +- %.3f\n", k, known.parameter_names[0].c_str(), known.theta(0, k),
                known.theta_standard_error(0, k));
  std::printf("log-likelihood %.1f, one Kalman filter %.1f\n", learned.log_likelihood, learned.baseline_log_likelihood);

  // Use of the filter: which ground is it?
  int right = 0;
  const int ice = std::abs(known.theta(0, 0) - grounds[1].a) < std::abs(known.theta(0, 1) - grounds[1].a) ? 0 : 1;
  const modebank::RecordedRun& held_out = runs.runs.back();
  modebank::filter::BankFilter filter(learned.bank);
  for (int k = 0; k < samples; ++k) {
    const auto& now = filter.step(held_out.time_s[k], &held_out.input.values[2 * k], &held_out.state.values[k]);
    const bool on_ice = now.mode_probability[ice] > 0.5;
    right += k > 0 && on_ice == (ground_at(k - 1) == 1) ? 1 : 0;
  }
  const double share = right / (samples - 1.0);
  std::printf("ground told right in %.1f %% of the samples\n", 100.0 * share);

  bool found = std::abs(by_yaw_model.theta(0, 0) - windows.theta(0, 0)) < 0.05 && learned.bank.modes() == 2 &&
               share > 0.9 && learned.log_likelihood > learned.baseline_log_likelihood && other_eigen_sum() == before;
  for (const Ground& truth : grounds)
    found = found && distance(clusters.mixture.means, truth) < 0.02 && distance(known.theta, truth) < 0.01;
  return found ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "identify: %s\n", error.what()), 1;
}
