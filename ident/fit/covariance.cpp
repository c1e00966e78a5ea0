#include "ident/fit/covariance.hpp"

#include <algorithm>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/fit/constants.hpp"

namespace modebank {

namespace {

/// G counts as singular if its reciprocal condition number is smaller.
constexpr double least_correlation_rcond = 1e-10;

Eigen::MatrixXd undefined(const WhitenedProblem& problem) {
  return Eigen::MatrixXd::Constant(problem.basis.rows(), problem.basis.rows(), not_a_number);
}

Eigen::MatrixXd prior_information(const WhitenedProblem& problem) {
  const auto P = problem.J.bottomRows(problem.prior_rows());
  return P.transpose() * P;
}

auto sample_rows(const WhitenedProblem& problem, Index k) {
  return problem.J.middleRows(k * problem.states, problem.states);
}

/// f in covariance.hpp: the sum of the samples' leverages, per state. (The columns of a state are zero in the rows of
/// other states.)
Eigen::ArrayXd determined_by_data(const WhitenedProblem& problem) {
  Eigen::ArrayXd f = Eigen::ArrayXd::Zero(problem.states);
  for (Index k = 0; k < problem.samples; ++k)
    for (Index i = 0; i < problem.states; ++i) f(i) += problem.J.row(k * problem.states + i).squaredNorm();
  return f;
}

/// Diagonals of psi' (influence_slope), L x n.
Eigen::ArrayXXd slopes(const CovarianceInput& in) {
  const auto r = in.terms.samples(in.problem.states);
  return (r.square().colwise() * (2.0 * in.terms.curvature.array())).colwise() + in.terms.weight.array();
}

/// G^-1 in covariance.hpp. Zero (no information) if the mean slope of psi is not positive.
Eigen::MatrixXd inverse_G(const CovarianceInput& in) {
  const Index L = in.problem.samples, n = in.problem.states;
  const auto r = in.terms.samples(n);
  const Eigen::MatrixXd psi = r.colwise() * in.terms.weight.array();
  const Eigen::MatrixXd psi_square = psi.transpose().lazyProduct(psi);
  const Eigen::ArrayXXd d = slopes(in);
  const Eigen::VectorXd w = Eigen::VectorXd::Ones(L);
  const Eigen::VectorXd slope = d.matrix().transpose().lazyProduct(w),
                        slope_square = d.square().matrix().transpose().lazyProduct(w);
  if (!(slope.minCoeff() > 0.0)) return Eigen::MatrixXd::Zero(n, n);
  const Eigen::ArrayXd mean_slope = slope / static_cast<double>(L);
  const Eigen::ArrayXd variance = (slope_square.array() / static_cast<double>(L) - mean_slope.square()).max(0.0);
  const Eigen::ArrayXd f = determined_by_data(in.problem);
  const Eigen::ArrayXd K = 1.0 + f / static_cast<double>(L) * variance / mean_slope.square();
  const Eigen::VectorXd factor = K / mean_slope / (static_cast<double>(L) - f).sqrt();
  Eigen::MatrixXd G = factor.asDiagonal() * psi_square * factor.asDiagonal();
  G.diagonal() = G.diagonal().cwiseMax(in.floor);

  const Eigen::VectorXd inverse_sd = G.diagonal().cwiseSqrt().cwiseInverse();
  const Cholesky correlation(inverse_sd.asDiagonal() * G * inverse_sd.asDiagonal());
  if (!correlation.definite() || correlation.rcond() < least_correlation_rcond)
    return inverse_sd.cwiseAbs2().asDiagonal();
  return inverse_sd.asDiagonal() * correlation.inverse() * inverse_sd.asDiagonal();
}

/// (sum J_k' G_inverse J_k + P)^-1 in coordinates z; NaN if it is not definite.
Eigen::MatrixXd from_information(const WhitenedProblem& problem, const Eigen::MatrixXd& G_inverse) {
  Eigen::MatrixXd information = prior_information(problem);
  if (problem.states == 1) {
    const auto J = problem.J.topRows(problem.samples);
    information += G_inverse(0, 0) * J.transpose().lazyProduct(J);
  } else {
    for (Index k = 0; k < problem.samples; ++k)
      information += sample_rows(problem, k).transpose() * G_inverse * sample_rows(problem, k);
  }
  return definite_inverse(information)
      .value_or(Eigen::MatrixXd::Constant(information.rows(), information.cols(), not_a_number));
}

/// Influence of sample k on a fit without this sample: (I - h_k)^-1 psi_k.
Eigen::VectorXd left_out_influence(const CovarianceInput& in, Index k, const Eigen::MatrixXd& H_inverse,
                                   const Eigen::MatrixXd& slope) {
  const Index n = in.problem.states;
  const auto J = sample_rows(in.problem, k);
  const Eigen::VectorXd psi = in.terms.weight(k) * in.terms.sample(k, n);
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(n, n) - slope * (J * H_inverse * J.transpose());
  if (n == 1) return psi / std::max(rest(0, 0), least_one_minus_leverage);
  const PivotedLu factor(rest);
  return factor.rcond() > least_one_minus_leverage ? factor.solve(psi) : psi;
}

Eigen::MatrixXd sandwich(const CovarianceInput& in) {
  const Index z = in.problem.unknowns(), n = in.problem.states;
  Cholesky factor(hessian(in.problem, in.terms));
  const bool exact = factor.definite();
  if (!exact) factor.factorise(weighted_information(in.problem, in.terms));
  if (!factor.definite()) return Eigen::MatrixXd::Constant(z, z, not_a_number);
  const Eigen::MatrixXd H_inverse = factor.inverse();

  Eigen::MatrixXd meat = prior_information(in.problem);
  for (Index k = 0; k < in.problem.samples; ++k) {
    const Eigen::MatrixXd slope =
        exact ? in.terms.influence_slope(k, n) : Eigen::MatrixXd(in.terms.weight(k) * Eigen::MatrixXd::Identity(n, n));
    const Eigen::VectorXd direction =
        sample_rows(in.problem, k).transpose() * left_out_influence(in, k, H_inverse, slope);
    meat += direction * direction.transpose();
  }
  return H_inverse * meat * H_inverse;
}

Eigen::MatrixXd z_covariance(const CovarianceInput& in, CovarianceKind kind) {
  const Index n = in.problem.states;
  if (in.problem.samples <= in.regressors) return from_information(in.problem, Eigen::MatrixXd::Identity(n, n));
  return kind == CovarianceKind::model ? from_information(in.problem, inverse_G(in)) : sandwich(in);
}

}  // namespace

Eigen::MatrixXd theta_covariance(const CovarianceInput& in, CovarianceKind kind) {
  if (in.problem.unknowns() < in.problem.basis.rows()) return undefined(in.problem);
  const Eigen::MatrixXd covariance = in.problem.basis * z_covariance(in, kind) * in.problem.basis.transpose();
  return 0.5 * (covariance + covariance.transpose());
}

Eigen::VectorXd weighed_information(const CovarianceInput& in, CovarianceKind kind) {
  const Index n = in.problem.states;
  const Eigen::VectorXd w = Eigen::VectorXd::Ones(in.problem.samples);
  const Eigen::ArrayXd slope = slopes(in).matrix().transpose() * w / static_cast<double>(in.problem.samples);
  if (in.problem.samples <= in.regressors) return slope.max(0.0);
  if (kind == CovarianceKind::sandwich) return Eigen::VectorXd::Constant(n, not_a_number);
  const Eigen::ArrayXd stated = inverse_G(in).diagonal();
  return (stated > 0.0).select(slope / stated, 1.0).matrix();
}

}  // namespace modebank
