#pragma once

#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "ident/fit/global_model.hpp"
#include "tests/support/golden.hpp"

namespace modebank::test {

inline Recording empty_recording(Index n, Index m) {
  Recording recording;
  for (Index i = 0; i < n; ++i) recording.states.push_back({"x" + std::to_string(i), "m"});
  for (Index i = 0; i < m; ++i) recording.inputs.push_back({"u" + std::to_string(i), ""});
  return recording;
}

/// Adds a run with samples 0.1 s apart.
inline void add_run(Recording& recording, Eigen::MatrixXd state, Eigen::MatrixXd input, Role role = Role::train) {
  Trajectory run;
  run.run = "run" + std::to_string(recording.runs.size());
  run.role = role;
  run.time_s = Eigen::VectorXd::LinSpaced(state.cols(), 0.0, 0.1 * static_cast<double>(state.cols() - 1));
  run.state = std::move(state);
  run.input = std::move(input);
  recording.runs.push_back(std::move(run));
}

/// Runs of one state under a white input of unit variance. `next(x, u, k, noise)`: x[k+1] of a run, with standard
/// normal noise.
template <class Next>
Recording simulated_runs(Index runs, Index samples, std::uint64_t seed, Next next) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  Recording recording = empty_recording(1, 1);
  for (Index run = 0; run < runs; ++run) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, samples), u(1, samples);
    for (double& value : u.reshaped()) value = normal(generator);
    for (Index k = 0; k + 1 < samples; ++k) x(k + 1) = next(x, u, k, normal(generator));
    add_run(recording, x, u);
  }
  return recording;
}

inline LinearStructure structure_of(const Recording& recording) {
  return {recording.state_count(), recording.input_count(), false};
}

/// Windows of every training run. They have only the fields that a bank needs: the global fit.
inline WindowFits windows_of(const Recording& recording, Index length, Index step) {
  WindowFits fits;
  fits.structure = structure_of(recording);
  fits.length = length;
  fits.step = step;
  const WindowPlan plan(recording, length, step);
  for (Index i = 0; i < plan.count(); ++i) fits.windows.push_back(plan.window(i));
  fits.global = fit_global(recording, fits.structure);
  return fits;
}

/// A mixture of K components of equal weight around the global theta. Its memberships are `responsibilities` (K x M). A
/// window with a NaN column is not clustered.
inline MixtureResult mixture_of(const WindowFits& fits, const Eigen::MatrixXd& responsibilities) {
  const Index K = responsibilities.rows(), p = fits.parameter_count();
  MixtureResult result;
  result.mixture.weights = Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K));
  result.mixture.means = fits.global.theta.replicate(1, K);
  result.mixture.covariances.assign(K, Eigen::MatrixXd::Identity(p, p));
  result.responsibilities = responsibilities;
  result.labels = Eigen::VectorXi::Constant(fits.count(), -1);
  for (Index i = 0; i < fits.count(); ++i)
    if (!std::isnan(responsibilities(0, i))) responsibilities.col(i).maxCoeff(&result.labels(i));
  return result;
}

}  // namespace modebank::test
