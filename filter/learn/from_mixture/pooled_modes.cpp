#include "filter/learn/from_mixture/pooled_modes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <unsupported/Eigen/KroneckerProduct>
#include <vector>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/stacked_triangle.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/linearise.hpp"
#include "ident/fit/motion_fit.hpp"
#include "mixture/features.hpp"
#include "mixture/gaussian_mixture.hpp"

namespace modebank {

MixtureResult cluster_windows(const Recording& recording, const WindowFits& fits, const FitOptions& window,
                              const ClusterOptions& options, std::uint64_t seed) {
  std::optional<WindowFits> one_lag;
  if (clusters_one_lag(fits, options.features)) one_lag = fit_one_lag(recording, fits, window);
  const WindowFits& seen = one_lag ? *one_lag : fits;
  const FeatureCloud cloud = make_features(seen, recording.states, options);
  MixtureResult result = select_mixture(seen, cloud, options.selection, seed, nullptr,
                                        assigned_features(seen, recording.states, options, cloud.names));
  const std::vector<std::string> first = seen.parameter_names();
  if (!one_lag && cloud.names.size() >= first.size() && std::equal(first.begin(), first.end(), cloud.names.begin()))
    return result;
  const FeatureCloud all = in_features(
      make_features(seen, FeatureSet::parameters_and_noise, WindowChoice::all, recording.states), cloud.names);
  result.features = Eigen::MatrixXd::Constant(all.points.rows(), fits.count(), not_a_number);
  result.features(Eigen::all, all.windows) = all.points;
  return result;
}

namespace {

/// The window nearest to a transition that no window covers. `windows`: at least one, by increasing start.
Index nearest_window(Index transition, const std::vector<Index>& windows, const WindowFits& fits) {
  const auto after = std::partition_point(windows.begin(), windows.end(),
                                          [&](Index i) { return fits.windows[i].start <= transition; });
  if (after == windows.begin()) return *after;
  const auto before = std::prev(after);
  if (after == windows.end()) return *before;
  const Index gap_before = transition - (fits.windows[*before].start + fits.length - 1);
  return gap_before <= fits.windows[*after].start - transition ? *before : *after;
}

/// The rows of one run, count x K. `windows`: its windows by increasing start.
Eigen::MatrixXd memberships_of_run(Index count, std::vector<Index> windows, const WindowFits& fits,
                                   const MixtureResult& mixture) {
  const Index first = windows.empty() ? 0 : windows.front(), end = windows.empty() ? 0 : windows.back() + 1;
  const Eigen::MatrixXd gamma = mixture.responsibilities.block(first, end - first);
  std::erase_if(windows, [&](Index i) { return std::isnan(gamma(0, i - first)); });  // not clustered
  if (windows.empty()) return mixture.mixture.weights.transpose().replicate(count, 1);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(gamma.rows(), count);
  Eigen::VectorXd covering = Eigen::VectorXd::Zero(count);
  for (const Index i : windows) {
    sum.middleCols(fits.windows[i].start, fits.length).colwise() += gamma.col(i - first);
    covering.segment(fits.windows[i].start, fits.length).array() += 1.0;
  }
  for (Index k = 0; k < count; ++k)
    if (covering(k) > 0.0)
      sum.col(k) /= covering(k);
    else
      sum.col(k) = gamma.col(nearest_window(k, windows, fits) - first);
  return sum.transpose();
}

constexpr double smallest_weight = 1e-9;  // transitions; less has no information about Q
/// Number of transitions per decomposition: of a long recording no copy is needed.
constexpr Index block_rows = Index{1} << 18;

/// Sums of the weighted transitions about their own least squares fit. This avoids cancellation.
struct WeightedRegression {
  Eigen::MatrixXd beta;  // q x n, least-squares coefficients; directions without data are those of the global model
  RegressionSums sums;   // H is zero, except for rounding and for directions without data
};

WeightedRegression regress(const TrainingTransitions& transitions, const Eigen::VectorXd& weights,
                           const Eigen::VectorXd& global_theta) {
  const Index N = transitions.count(), q = transitions.data.regressors.cols(), n = transitions.data.increments.cols();
  const auto X = [&](Index first) {
    return transitions.data.regressors.middleRows(first, std::min(block_rows, N - first));
  };
  const auto residuals = [&](Index first, const Eigen::MatrixXd& beta) -> Eigen::MatrixXd {
    return transitions.data.increments.middleRows(first, X(first).rows()) - X(first) * beta;
  };
  Eigen::MatrixXd beta = coefficients(transitions.structure, global_theta), rows(0, q + n);
  for (Index first = 0; first < N; first += block_rows) {
    const Eigen::VectorXd root = weights.segment(first, X(first).rows()).cwiseSqrt();
    Eigen::MatrixXd block(root.size(), q + n);
    block << root.asDiagonal() * X(first), root.asDiagonal() * residuals(first, beta);
    rows = first == 0 ? block : stacked_triangle(rows, block);
  }
  beta += solve(decompose(rows.leftCols(q), excitation_tolerance), rows.rightCols(n));
  RegressionSums sums{Eigen::MatrixXd::Zero(q, q), Eigen::MatrixXd::Zero(q, n), Eigen::MatrixXd::Zero(n, n)};
  for (Index first = 0; first < N; first += block_rows)
    sums = sums + regression_sums(X(first), weights.segment(first, X(first).rows()), residuals(first, beta));
  return {beta, sums};
}

/// Inverse prior covariance, p x p; zero without a prior.
Eigen::MatrixXd prior_information(Index parameters, const ParameterPrior* prior) {
  if (!prior) return Eigen::MatrixXd::Zero(parameters, parameters);
  return prior->sd.array().square().inverse().matrix().asDiagonal();
}

/// The inverse of an information matrix, NaN if it does not determine every parameter.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& information) {
  const Index p = information.rows();
  const Eigen::MatrixXd not_determined = Eigen::MatrixXd::Constant(p, p, not_a_number);
  if (!(information.diagonal().minCoeff() > 0.0) || !information.allFinite()) return not_determined;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const auto [values, vectors] = symmetric_eigen(scale.asDiagonal() * information * scale.asDiagonal());
  if (values.minCoeff() < excitation_tolerance * excitation_tolerance) return not_determined;
  const Eigen::MatrixXd root = scale.asDiagonal() * vectors;
  return root * values.cwiseInverse().asDiagonal() * root.transpose();
}

/// Empty if Q is not positive definite.
std::optional<Eigen::MatrixXd> regularised(const WeightedRegression& data, const Eigen::MatrixXd& Q,
                                           const ParameterPrior& prior) {
  const std::optional<Eigen::MatrixXd> Q_inverse = definite_inverse(Q);
  if (!Q_inverse) return std::nullopt;
  const Eigen::MatrixXd P_inverse = prior_information(data.beta.size(), &prior);
  const Eigen::MatrixXd information = Eigen::kroneckerProduct(*Q_inverse, data.sums.G).eval() + P_inverse;
  const Eigen::MatrixXd data_pull = data.sums.H * *Q_inverse;
  const Eigen::VectorXd pull = data_pull.reshaped() + P_inverse * (prior.mean - data.beta.reshaped());
  return Eigen::MatrixXd(data.beta +
                         solve_semidefinite(information, pull).reshaped(data.beta.rows(), data.beta.cols()));
}

/// scatter / weight with its eigenvalues raised to the floor, in units of the global residual variances; those of the
/// global model if there is no weight.
Eigen::MatrixXd process_noise(const Eigen::MatrixXd& scatter, double weight, const GlobalModel& global) {
  const Eigen::MatrixXd Q = weight < smallest_weight ? global.residual_covariance : scatter / weight;
  const Eigen::VectorXd sd = global.noise_variance().unaryExpr(&positive_variance).cwiseSqrt();
  Eigen::MatrixXd whitened = sd.cwiseInverse().asDiagonal() * Q * sd.cwiseInverse().asDiagonal();
  if (!raise_to_floor(whitened, process_noise_floor, CovarianceType::full)) return Q;
  return sd.asDiagonal() * whitened * sd.asDiagonal();
}

Eigen::VectorXd standard_errors(const WeightedRegression& data, const Eigen::MatrixXd& Q, const ParameterPrior* prior) {
  const double q = static_cast<double>(data.sums.G.rows());
  const Eigen::MatrixXd Q_unbiased = Q * (data.sums.weight / std::max(data.sums.weight - q, 1.0));
  Eigen::MatrixXd information = prior_information(data.beta.size(), prior);
  if (data.sums.weight >= smallest_weight) {
    const std::optional<Eigen::MatrixXd> Q_inverse = definite_inverse(Q_unbiased);
    if (!Q_inverse) return Eigen::VectorXd::Constant(data.beta.size(), not_a_number);
    information += Eigen::kroneckerProduct(*Q_inverse, data.sums.G).eval();
  }
  return covariance_of(information).diagonal().cwiseSqrt();
}

/// The process noise about theta.
Eigen::MatrixXd noise_of(const ModelResiduals& residuals, const ModeEstimate& mode, const GlobalModel& global) {
  const Index n = residuals.states();
  Eigen::VectorXd r;
  residuals.evaluate(mode.motion_theta.data(), r, nullptr);
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(n, n);
  for (Index k = 0; k < residuals.samples(); ++k)
    scatter += residuals.weight(k) * r.segment(k * n, n) * r.segment(k * n, n).transpose();
  return process_noise(scatter, mode.effective_transitions, global);
}

/// (sum g J' Q^-1 J + prior)^-1, with Q corrected for the number of fitted parameters. NaN if theta is not determined.
Eigen::MatrixXd motion_covariance(const ModelResiduals& residuals, const ModeEstimate& mode,
                                  const ParameterPrior* prior) {
  const Index n = residuals.states(), p = residuals.unknowns();
  const double W = mode.effective_transitions, lost = static_cast<double>(p) / static_cast<double>(n);
  const Eigen::MatrixXd Q_inverse = solve_semidefinite(mode.Q, Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n))) *
                                    (std::max(W - lost, 1.0) / std::max(W, 1.0));
  Eigen::VectorXd r;
  RowMajorJacobian J;
  residuals.evaluate(mode.motion_theta.data(), r, &J);
  Eigen::MatrixXd information = prior_information(p, prior);
  for (Index k = 0; k < residuals.samples(); ++k)
    information += residuals.weight(k) * J.middleRows(k * n, n).transpose() * Q_inverse * J.middleRows(k * n, n);
  return covariance_of(information);
}

/// Alternates between theta and the residual variances until both converge.
void estimate_theta(const ModelResiduals& residuals, const GlobalModel& global, const ParameterPrior* prior,
                    ModeEstimate& mode) {
  constexpr int most_passes = 50, search_iterations = 200;
  constexpr double tolerance = 1e-10;  // relative change of the diagonal of Q
  const RobustLoss least_squares(Loss::trivial, 0.0);
  bool converged = false;
  for (int pass = 0; pass < most_passes && !converged; ++pass) {
    const Eigen::VectorXd variance = mode.Q.diagonal();
    const ModelMinimum minimum =
        minimise_model(residuals, variance.cwiseSqrt(), least_squares, prior, search_iterations, mode.motion_theta);
    if (minimum.status == FitStatus::failed) return;
    mode.motion_theta = minimum.theta;
    mode.Q = noise_of(residuals, mode, global);
    converged = (mode.Q.diagonal() - variance).norm() <= tolerance * variance.norm();
  }
}

}  // namespace

Eigen::MatrixXd transition_memberships(const TrainingTransitions& transitions, const WindowFits& fits,
                                       const MixtureResult& mixture) {
  std::vector<std::vector<Index>> by_run(transitions.runs.back().run + 1);
  for (Index i = 0; i < fits.count(); ++i) by_run.at(fits.windows[i].run).push_back(i);
  Eigen::MatrixXd memberships(transitions.count(), mixture.mixture.components());
  for (const RunRows& rows : transitions.runs)
    memberships.middleRows(rows.first, rows.count) = memberships_of_run(rows.count, by_run[rows.run], fits, mixture);
  if (mixture.mixture.noise.present()) return transitions.usable.asDiagonal() * memberships;
  // Every row already sums to one, except for rounding. With exact sums, the weights of the modes add up to N.
  return transitions.usable.cwiseQuotient(memberships.rowwise().sum()).asDiagonal() * memberships;
}

ModeEstimate fit_weighted_mode(const TrainingTransitions& transitions, const Eigen::VectorXd& weights,
                               const GlobalModel& global, const ParameterPrior* prior, const Eigen::VectorXd* given) {
  constexpr double tolerance = 1e-12;  // relative change of Q; rounding errors are a thousand times smaller
  constexpr int most_alternations = 500;
  const WeightedRegression data = regress(transitions, weights, global.theta);
  const auto noise_about = [&](const Eigen::MatrixXd& beta) {
    return process_noise(data.sums.scatter_after(beta - data.beta), data.sums.weight, global);
  };
  Eigen::MatrixXd beta = given ? coefficients(transitions.structure, *given) : data.beta, Q = noise_about(beta);
  bool converged = given || !prior;
  for (int i = 0; i < most_alternations && !converged; ++i) {
    const std::optional<Eigen::MatrixXd> next = regularised(data, Q, *prior);
    if (!next) break;
    beta = *next;
    const Eigen::MatrixXd previous = Q;
    Q = noise_about(beta);
    converged = (Q - previous).norm() <= tolerance * previous.norm();
  }
  return {beta.reshaped(), Q, standard_errors(data, Q, prior), data.sums.weight};
}

ModeEstimate fit_motion_mode(const Recording& recording, const MotionModel& model, const Eigen::VectorXd& weights,
                             const GlobalModel& global, const ParameterPrior* prior, const Eigen::VectorXd* given) {
  const ModelResiduals residuals(model, training_stretches(recording), weights);
  ModeEstimate mode;
  mode.motion_theta = given ? *given : global.theta;
  for (Index k = 0; k < residuals.samples(); ++k) mode.effective_transitions += residuals.weight(k);
  mode.Q = noise_of(residuals, mode, global);
  if (!given) estimate_theta(residuals, global, prior, mode);
  const Eigen::MatrixXd covariance = motion_covariance(residuals, mode, prior);
  mode.motion_standard_error = covariance.diagonal().cwiseSqrt();
  const LinearisedMotion linear = linearise(model, mode.motion_theta, operating_point(recording, weights));
  mode.by_motion = linear.by_motion;
  mode.theta = linear.theta;
  mode.standard_error =
      (linear.by_motion * covariance * linear.by_motion.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  return mode;
}

}  // namespace modebank
