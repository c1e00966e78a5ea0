#include "ident/fit/global_model.hpp"

#include <cmath>
#include <utility>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/stacked_triangle.hpp"
#include "ident/fit/motion_fit.hpp"
#include "ident/model/transitions.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

std::vector<Index> unidentifiable_columns(const Eigen::MatrixXd& X, const Decomposition& d) {
  constexpr double rounding = 1e-6;  // share of a squared length; far below the share of any true dependence
  const Index q = d.basis.rows();
  std::vector<Index> unidentifiable;
  if (d.rank() == q) return unidentifiable;
  Eigen::MatrixXd rows(q, 0);
  if (d.rank() > 0) {
    const Eigen::VectorXd norms = X.colwise().stableNorm().transpose();
    rows = thin_qr((norms.array() > 0.0).select(norms, 1.0).cwiseInverse().asDiagonal() * d.basis).Q;
  }
  for (Index j = 0; j < q; ++j)
    if (1.0 - rows.row(j).squaredNorm() > rounding) unidentifiable.push_back(j);
  return unidentifiable;
}

namespace {

/// S (x) (X'X)^+ for theta row-major. NaN for parameters that the transitions do not determine.
Eigen::MatrixXd least_squares_covariance(const Eigen::MatrixXd& X, const Decomposition& d,
                                         const Eigen::MatrixXd& residual_square_sum, Index N) {
  const Index q = d.basis.rows(), n = residual_square_sum.rows(), rank = d.rank();
  if (N <= rank) return Eigen::MatrixXd::Constant(n * q, n * q, not_a_number);
  Eigen::MatrixXd gram_inverse = d.basis * d.basis.transpose();
  for (const Index j : unidentifiable_columns(X, d)) {
    gram_inverse.row(j).setConstant(not_a_number);
    gram_inverse.col(j).setConstant(not_a_number);
  }
  Eigen::MatrixXd covariance(n * q, n * q);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      covariance.block(i * q, j * q, q, q) = residual_square_sum(i, j) / static_cast<double>(N - rank) * gram_inverse;
  return covariance;
}

/// Reduces all training transitions to a few rows of the same least-squares problem, and counts the transitions. A QR
/// decomposition takes one block of rows after the other, so a long recording is not copied.
std::pair<Transitions, Index> reduce(const Recording& recording, const LinearStructure& structure) {
  const Index q = structure.regressors(), n = structure.states;
  Eigen::MatrixXd triangle(0, q + n);
  Index count = 0;
  for_each_training_block(recording, structure, [&](const Transitions& block) {
    count += block.count();
    Eigen::MatrixXd rows(block.count(), q + n);
    rows << block.regressors, block.increments;
    triangle = stacked_triangle(triangle, rows);
  });
  return {{triangle.leftCols(q), triangle.rightCols(n)}, count};
}

constexpr int motion_iterations = 1000;
// number of fits of the motion model; each fit weights the states by the residual standard deviations of the previous
// fit
constexpr int scale_passes = 3;

/// Root mean square per state.
Eigen::VectorXd root_mean_square(const Eigen::VectorXd& r, Index n) {
  const Index samples = std::max(Index{1}, r.size() / n);
  return (r.reshaped(n, r.size() / n).rowwise().squaredNorm() / static_cast<double>(samples)).cwiseSqrt();
}

Eigen::VectorXd positive_or_one(const Eigen::VectorXd& values) {
  return values.unaryExpr([](double value) { return value > 0.0 && std::isfinite(value) ? value : 1.0; });
}

Eigen::VectorXd start_of(const MotionModel& model) {
  Eigen::VectorXd theta(model.parameter_count());
  for (Index j = 0; j < theta.size(); ++j) theta(j) = model.parameters()[static_cast<std::size_t>(j)].start;
  return theta;
}

}  // namespace

GlobalModel fit_global(const Recording& recording, const LinearStructure& structure) {
  const auto [transitions, N] = reduce(recording, structure);
  if (N == 0) throw DataError("the training runs hold no transition between two finite samples");
  const Decomposition d = decompose(transitions.regressors, excitation_tolerance);
  const Eigen::MatrixXd coefficients = solve(d, transitions.increments);
  Eigen::MatrixXd square_sum = Eigen::MatrixXd::Zero(structure.states, structure.states);
  for_each_training_block(recording, structure, [&](const Transitions& block) {
    const Eigen::MatrixXd r = block.increments - block.regressors * coefficients;
    square_sum += r.transpose() * r;
  });
  GlobalModel global;
  // Column i of the coefficients is row i of [A B c], so their column-major vec is theta.
  global.theta = coefficients.reshaped();
  global.covariance = least_squares_covariance(transitions.regressors, d, square_sum, N);
  global.residual_covariance = square_sum / static_cast<double>(N);
  global.transitions = N;
  return global;
}

bool needs_constant(const Recording& recording, LinearStructure structure) {
  constexpr double least_gain = 6.0;  // [nats]
  constexpr Index rows_per_column = 3;
  structure.intercept = true;
  if (reduce(recording, structure).second < rows_per_column * structure.regressors()) return false;
  const GlobalModel with = fit_global(recording, structure);
  structure.intercept = false;
  structure.centre.clear();
  const GlobalModel without = fit_global(recording, structure);
  const auto log_determinant = [](const GlobalModel& fit) { return std::log(fit.residual_covariance.determinant()); };
  return static_cast<double>(with.transitions) / 2.0 * (log_determinant(without) - log_determinant(with)) >= least_gain;
}

std::vector<Index> unidentifiable_regressors(const Recording& recording, const LinearStructure& structure) {
  const auto [transitions, N] = reduce(recording, structure);
  if (N == 0) return {};
  return unidentifiable_columns(transitions.regressors, decompose(transitions.regressors, excitation_tolerance));
}

GlobalModel fit_global(const Recording& recording, const MotionModel& model) {
  const ModelResiduals residuals(model, training_stretches(recording));
  if (residuals.samples() == 0) throw DataError("the training runs hold no transition between two finite samples");
  const Index n = model.states(), p = model.parameter_count(), N = residuals.samples();
  const RobustLoss least_squares(Loss::trivial, 0.0);
  GlobalModel global;
  global.theta = start_of(model);
  Eigen::VectorXd r;
  residuals.evaluate(global.theta.data(), r, nullptr);
  for (int pass = 0; pass < (n > 1 ? scale_passes : 1); ++pass) {
    const Eigen::VectorXd sigma = positive_or_one(root_mean_square(r, n));
    global.theta = minimise_model(residuals, sigma, least_squares, nullptr, motion_iterations, global.theta).theta;
    residuals.evaluate(global.theta.data(), r, nullptr);
  }
  const auto errors = r.reshaped(n, N);
  global.residual_covariance = errors * errors.transpose() / static_cast<double>(N);
  global.transitions = N;
  FitOptions options;
  options.loss = Loss::trivial;
  const Eigen::VectorXd sigma = positive_or_one(root_mean_square(r, n));
  global.covariance =
      fit_model(residuals, make_model_estimator(model, options), sigma, Eigen::VectorXd::Zero(n), nullptr, global.theta)
          .covariance;
  if (global.covariance.rows() != p) global.covariance = Eigen::MatrixXd::Constant(p, p, not_a_number);
  return global;
}

}  // namespace modebank
