#include "ident/fit/describe.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/log_two_pi.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/fit/constants.hpp"
#include "ident/fit/covariance.hpp"

namespace modebank {

namespace {

/// Noise variance of each state, as defined at fit_window.
Eigen::VectorXd noise_variance(const SolvedWindow& s) {
  const auto L = static_cast<double>(s.problem.samples);
  const bool short_window = L <= s.unknowns_per_state;
  const double divisor = short_window ? L : (L - s.rank_per_state) * s.consistency;
  const Eigen::ArrayXXd squares = s.terms.samples(s.problem.states).square();
  const Eigen::VectorXd sum = short_window ? squares.colwise().sum().matrix().transpose().eval()
                                           : (squares.matrix().transpose() * s.terms.weight).eval();
  return (sum.array() / divisor * s.scale.sigma.array().square()).max(s.scale.floor.array().square());
}

Eigen::VectorXd information(const Eigen::MatrixXd& covariance, const ParameterPrior* prior) {
  if (!prior) return Eigen::VectorXd::Constant(covariance.rows(), not_a_number);
  return 1.0 - covariance.diagonal().array() / prior->sd.array().square();
}

Eigen::VectorXd sample_weights(const WhitenedProblem& problem) {
  return problem.weight.size() > 0 ? problem.weight : Eigen::VectorXd::Ones(problem.samples);
}

/// Residuals of state i in units of sigma, each times the square root of its sample weight.
auto residuals_of(const WhitenedProblem& problem, const RobustTerms& terms, Index i) {
  using Strided = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  return Strided(terms.residual.data() + i, problem.samples, Eigen::InnerStride<>(problem.states));
}

double gaussian_deviance(const WhitenedProblem& problem, const RobustTerms& terms, const NoiseScale& scale) {
  const double L = static_cast<double>(problem.samples);
  double deviance = 0.0;
  for (Index i = 0; i < problem.states; ++i) {
    const double mean_square = residuals_of(problem, terms, i).squaredNorm() / L;
    const double floor = scale.floor(i) / scale.sigma(i);
    const double variance = std::max(mean_square, floor * floor);
    deviance += L * (log_two_pi + std::log(variance) + 2.0 * std::log(scale.sigma(i)) + 1.0);
  }
  return deviance;
}

double robust_deviance(const WhitenedProblem& problem, const RobustTerms& terms, const RobustLoss& loss,
                       const Eigen::VectorXd& sigma) {
  const double L = static_cast<double>(problem.samples);
  double deviance = L * (static_cast<double>(problem.states) * log_two_pi + 2.0 * sigma.array().log().sum());
  for (Index k = 0; k < problem.samples; ++k) {
    const double w = problem.sample_weight(k);
    deviance += w * loss(terms.sample(k, problem.states).squaredNorm() / w).rho;
  }
  return deviance;
}

/// sum w psi^2 / sum w psi' over all samples and states.
double price_of_a_parameter(const WhitenedProblem& problem, const RobustTerms& terms) {
  double psi_square = 0.0, slope = 0.0;
  for (Index k = 0; k < problem.samples; ++k) {
    const double square = terms.sample(k, problem.states).squaredNorm();
    psi_square += terms.weight(k) * terms.weight(k) * square;
    const double trace = static_cast<double>(problem.states) * terms.weight(k) + 2.0 * terms.curvature(k) * square;
    slope += problem.sample_weight(k) * trace;  // trace of the influence function's slope
  }
  return slope > 0.0 ? psi_square / slope : not_a_number;
}

}  // namespace

Eigen::VectorXd r_squared(const Transitions& transitions, const WhitenedProblem& problem, const RobustTerms& terms,
                          const Eigen::VectorXd& sigma) {
  const Eigen::ArrayXd root = sample_weights(problem).cwiseSqrt();  // the rows already contain the square root of the
                                                                    // weight
  const Eigen::ArrayXd omega = terms.weight;
  Eigen::VectorXd result(problem.states);
  for (Index i = 0; i < problem.states; ++i) {
    const Eigen::ArrayXd d = transitions.increments.col(i);
    const double mean = (omega * root * d).sum() / (omega * root.square()).sum();
    const double total = (omega * (d - mean * root).square()).sum();
    const double left = (omega * residuals_of(problem, terms, i).array().square()).sum() * sigma(i) * sigma(i);
    result(i) = total > 0.0 ? 1.0 - left / total : not_a_number;
  }
  return result;
}

double akaike_criterion(const WhitenedProblem& problem, const RobustTerms& terms, const RobustLoss& loss,
                        const NoiseScale& scale) {
  const double n = static_cast<double>(problem.states);
  const double parameters = problem.J.topRows(problem.sample_rows()).squaredNorm();  // J'J = I, so this is the sum of
                                                                                     // the leverages
  const double weights = problem.weight.size() > 0 ? n * problem.weight.array().log().sum() : 0.0;
  if (loss.kind() == Loss::trivial) return gaussian_deviance(problem, terms, scale) - weights + 2.0 * (parameters + n);
  const double price = price_of_a_parameter(problem, terms);
  return robust_deviance(problem, terms, loss, scale.sigma) - weights + 2.0 * (price * parameters + n);
}

LocalModel describe_fit(const SolvedWindow& s, const Eigen::VectorXd& theta) {
  const Index p = theta.size();
  LocalModel fit;
  fit.theta = theta;
  const Eigen::VectorXd relative_floor = (s.scale.floor.array() / s.scale.sigma.array()).square();
  const auto regressors = static_cast<Index>(std::ceil(s.unknowns_per_state));
  const CovarianceInput input{s.problem, s.terms, regressors, relative_floor};
  fit.covariance = theta_covariance(input, s.covariance).topLeftCorner(p, p);
  if (s.prior) fit.weighed_information = weighed_information(input, s.covariance);
  fit.noise_variance = noise_variance(s);
  // the fit overflowed
  if (!fit.theta.allFinite() || !fit.noise_variance.allFinite()) return failed_fit(p, s.problem.states);
  fit.information = information(fit.covariance, s.prior);
  fit.inlier_fraction = (s.terms.weight.array() >= inlier_weight).cast<double>().mean();
  fit.r_squared = r_squared(s.transitions, s.problem, s.terms, s.scale.sigma);
  fit.aic = akaike_criterion(s.problem, s.terms, s.loss, s.scale);
  fit.transitions = s.problem.samples;
  return fit;
}

LocalModel failed_fit(Index parameters, Index states) {
  LocalModel fit;
  fit.theta = Eigen::VectorXd::Constant(parameters, not_a_number);
  fit.covariance = Eigen::MatrixXd::Constant(parameters, parameters, not_a_number);
  fit.noise_variance = Eigen::VectorXd::Constant(states, not_a_number);
  fit.condition = not_a_number;
  fit.information = fit.theta;
  fit.inlier_fraction = not_a_number;
  fit.r_squared = fit.noise_variance;
  fit.aic = not_a_number;
  fit.status = FitStatus::failed;
  return fit;
}

}  // namespace modebank
