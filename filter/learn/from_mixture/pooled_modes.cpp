#include "filter/learn/from_mixture/pooled_modes.hpp"

#include <algorithm>
#include <optional>
#include <unsupported/Eigen/KroneckerProduct>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/stacked_triangle.hpp"
#include "mixture/gaussian_mixture.hpp"

namespace modebank {
namespace {

constexpr double smallest_weight = 1e-9;         // number of transitions; a smaller sum of weights has no information
                                                 // about Q
constexpr double alternation_tolerance = 1e-12;  // relative change of Q; rounding errors are a thousand times smaller
constexpr int max_alternations = 500;

/// Sums of the weighted transitions about their own least squares fit. This avoids cancellation.
struct WeightedRegression {
  Eigen::MatrixXd beta;  // q x n, least-squares coefficients; directions without data are those of the global model
  RegressionSums sums;   // H is zero, except for rounding and for directions without data
};

/// Number of transitions per decomposition. A long recording is decomposed in blocks, so that no copy of it is needed.
constexpr Index block_rows = Index{1} << 18;

WeightedRegression regress(const TrainingTransitions& transitions, const Eigen::VectorXd& weights,
                           const Eigen::VectorXd& global_theta) {
  const Index N = transitions.count(), q = transitions.data.regressors.cols(), n = transitions.data.increments.cols();
  const auto X = [&](Index first) {
    return transitions.data.regressors.middleRows(first, std::min(block_rows, N - first));
  };
  const auto residuals = [&](Index first, const Eigen::MatrixXd& beta) -> Eigen::MatrixXd {
    return transitions.data.increments.middleRows(first, X(first).rows()) - X(first) * beta;
  };
  const Eigen::MatrixXd beta_global = coefficients(transitions.structure, global_theta);
  const auto weighted_rows = [&](Index first) {
    const Eigen::VectorXd root = weights.segment(first, X(first).rows()).cwiseSqrt();
    Eigen::MatrixXd rows(root.size(), q + n);
    rows << root.asDiagonal() * X(first), root.asDiagonal() * residuals(first, beta_global);
    return rows;
  };
  Eigen::MatrixXd rows = weighted_rows(0);
  for (Index first = block_rows; first < N; first += block_rows) rows = stacked_triangle(rows, weighted_rows(first));
  const Eigen::MatrixXd delta = solve(decompose(rows.leftCols(q), excitation_tolerance), rows.rightCols(n));
  RegressionSums sums = regression_sums(X(0), weights.head(X(0).rows()), residuals(0, beta_global) - X(0) * delta);
  for (Index first = block_rows; first < N; first += block_rows)
    sums = sums + regression_sums(X(first), weights.segment(first, X(first).rows()),
                                  residuals(first, beta_global) - X(first) * delta);
  return {beta_global + delta, sums};
}

/// Inverse prior covariance, p x p; zero without a prior.
Eigen::MatrixXd prior_information(Index parameters, const ParameterPrior* prior) {
  if (!prior) return Eigen::MatrixXd::Zero(parameters, parameters);
  return prior->sd.array().square().inverse().matrix().asDiagonal();
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

Eigen::MatrixXd process_noise(const WeightedRegression& data, const Eigen::MatrixXd& beta, const GlobalModel& global) {
  if (data.sums.weight < smallest_weight) return floored_process_noise(global.residual_covariance, global);
  return floored_process_noise(data.sums.scatter_after(beta - data.beta) / data.sums.weight, global);
}

Eigen::VectorXd standard_errors(const WeightedRegression& data, const Eigen::MatrixXd& Q, const ParameterPrior* prior) {
  const double q = static_cast<double>(data.sums.G.rows());
  const Eigen::MatrixXd Q_unbiased = Q * (data.sums.weight / std::max(data.sums.weight - q, 1.0));
  const Index p = Q.rows() * data.sums.G.rows();
  Eigen::MatrixXd information = prior_information(p, prior);
  const Eigen::VectorXd not_determined = Eigen::VectorXd::Constant(p, not_a_number);
  if (data.sums.weight >= smallest_weight) {
    const std::optional<Eigen::MatrixXd> Q_inverse = definite_inverse(Q_unbiased);
    if (!Q_inverse) return not_determined;
    information += Eigen::kroneckerProduct(*Q_inverse, data.sums.G).eval();
  }
  if (!(information.diagonal().minCoeff() > 0.0) || !information.allFinite()) return not_determined;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const auto [values, vectors] = symmetric_eigen(scale.asDiagonal() * information * scale.asDiagonal());
  if (values.minCoeff() < excitation_tolerance * excitation_tolerance) return not_determined;
  const Eigen::MatrixXd root = scale.asDiagonal() * vectors;
  return (root.cwiseAbs2() * values.cwiseInverse()).cwiseSqrt();
}

}  // namespace

Eigen::MatrixXd floored_process_noise(const Eigen::MatrixXd& Q, const GlobalModel& global) {
  const Eigen::VectorXd sd = global.noise_variance().unaryExpr(&positive_variance).cwiseSqrt();
  Eigen::MatrixXd whitened = sd.cwiseInverse().asDiagonal() * Q * sd.cwiseInverse().asDiagonal();
  if (!raise_to_floor(whitened, process_noise_floor, CovarianceType::full)) return Q;
  return sd.asDiagonal() * whitened * sd.asDiagonal();
}

ModeEstimate fit_weighted_mode(const TrainingTransitions& transitions, const Eigen::VectorXd& weights,
                               const GlobalModel& global, const ParameterPrior* prior, const Eigen::VectorXd* given) {
  const WeightedRegression data = regress(transitions, weights, global.theta);
  Eigen::MatrixXd beta = given ? coefficients(transitions.structure, *given) : data.beta;
  Eigen::MatrixXd Q = process_noise(data, beta, global);
  bool converged = given || !prior;
  for (int i = 0; i < max_alternations && !converged; ++i) {
    const std::optional<Eigen::MatrixXd> next = regularised(data, Q, *prior);
    if (!next) break;  // not converged
    beta = *next;
    const Eigen::MatrixXd previous = Q;
    Q = process_noise(data, beta, global);
    converged = (Q - previous).norm() <= alternation_tolerance * previous.norm();
  }
  return {beta.reshaped(), Q, standard_errors(data, Q, prior), data.sums.weight, converged};
}

std::string screening_reason(const LinearStructure& structure, const ModeEstimate& mode) {
  if (mode.effective_transitions < static_cast<double>(structure.regressors() + 1)) return "starved";
  if (!(spectral_radius(unpack(structure, mode.theta)) <= 1.0 + spectral_radius_slack)) return "unstable";
  return "";
}

}  // namespace modebank
