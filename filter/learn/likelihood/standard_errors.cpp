#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unsupported/Eigen/KroneckerProduct>

#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/step/bank_filter.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

constexpr double difference_step = 1e-2;      // in standard errors or logarithms; the relative error is about 1e-4
constexpr double least_probability = 1e-100;  // smallest divisor whose square does not underflow
constexpr double most_numbers = 4e6;          // number of samples times number of coordinates; 32 MB
constexpr Index fewest_samples = 2000, most_samples = 20000;  // enough for an accuracy of a few per cent

/// Sum of the outer products of the gradients of `densities` of a bank, one per sample; zero without a density.
template <class Densities>
Eigen::MatrixXd outer_products(const BankCoordinates& around, const Eigen::VectorXd& steps, Index samples,
                               Densities densities) {
  Eigen::MatrixXd gradients(samples, around.size());
  tbb::parallel_for(Index{0}, around.size(), [&](Index c) {
    const Eigen::VectorXd step = steps(c) * Eigen::VectorXd::Unit(around.size(), c);
    gradients.col(c) = (densities(around.decode(step)) - densities(around.decode(-step))) / (2.0 * steps(c));
  });
  gradients = gradients.array().isNaN().select(0.0, gradients).eval();
  return gradients.transpose() * gradients;
}

/// Whether states count as measured exactly because R is at its bound.
bool is_exact(const BankCoordinates& around) {
  const Bank& bank = around.origin();
  const Eigen::VectorXd& least = around.free().least_R;
  return around.free().R.empty() && !bank.is_quantised() && bank.terms.empty() && least.size() > 0 &&
         (bank.R.diagonal().array() <= least.array()).all();
}

/// The prior on Q counts as a scatter of its number of transitions, that on T as its number of switches for every pair
/// of modes.
Eigen::MatrixXd prior_information(const BankCoordinates& around, const SwitchingPrior& prior) {
  const Bank& bank = around.origin();
  const FreeParameters& free = around.free();
  const Index n = bank.structure.states, p = free.theta_unit.rows(), K = bank.mode_count();
  const Eigen::MatrixXd J = around.jacobian();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(J.cols(), J.cols());
  Eigen::VectorXd of_noise = Eigen::VectorXd::Zero(J.rows());  // inverse variances of Q and T
  Index at = 0;
  for (Index j = 0; j < K; ++j) {
    if (p > 0 && (j == 0 || bank.motion_of(j) != bank.motion_of(j - 1)))
      information += J.middleRows(at, p).transpose() * prior.information * J.middleRows(at, p);
    at += p;
    const Eigen::MatrixXd& Q = bank.modes[j].Q;
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a)
        of_noise(at++) = (a == b ? 0.5 : 1.0) * prior.noise_transitions / (Q(a, a) * Q(b, b));
    if (!free.transition) continue;
    const Eigen::RowVectorXd row = bank.transition.matrix().row(j).cwiseMax(least_probability);
    of_noise.segment(at, K) = prior.counts * row.cwiseInverse().cwiseAbs2();
    at += K;
  }
  return information + J.transpose() * of_noise.asDiagonal() * J;
}

/// Covariance of the parameters in the order of BankCoordinates::jacobian. Empty if the information matrix is singular.
std::optional<Eigen::MatrixXd> observed_covariance(const LikelihoodTarget& target, const BankCoordinates& around) {
  const Index most =
      std::clamp(static_cast<Index>(most_numbers / static_cast<double>(around.size())), fewest_samples, most_samples);
  const Eigen::VectorXd steps = Eigen::VectorXd::Constant(around.size(), difference_step);
  const Eigen::MatrixXd information = observed_information(target, around, steps, most);
  if (!information.allFinite()) return std::nullopt;
  // Coordinates differ in scale by orders of magnitude, so the correlation matrix is factorised.
  const Eigen::VectorXd unit =
      information.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Cholesky factor(unit.asDiagonal() * information * unit.asDiagonal());
  if (!factor.definite()) return std::nullopt;
  const Eigen::MatrixXd root = factor.whiten(Eigen::MatrixXd(unit.asDiagonal() * around.jacobian().transpose()));
  Eigen::MatrixXd covariance = root.transpose() * root;
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0.0)) return std::nullopt;
  return covariance;
}

}  // namespace

Eigen::MatrixXd observed_information(const LikelihoodTarget& target, const BankCoordinates& around,
                                     const Eigen::VectorXd& steps, Index most) {
  const std::optional<Recording> part = learning_part(target.recording, most, 1);
  const Recording& recording = part ? *part : target.recording;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(around.size(), around.size());
  if (is_exact(around)) {
    // The densities of the switching regression equal those of the filter for R = 0, but cost far less, especially with
    // many lags.
    const TrainingTransitions transitions = gather_training_transitions(recording, around.origin().structure);
    sum = outer_products(around, steps, transitions.count(), [&](const Bank& bank) {
      return predictive_log_densities(transitions, switching_model(bank));
    });
  } else {
    for (const Trajectory& run : recording.runs)
      if (run.role == Role::train && run.samples() > 1)
        sum += outer_products(around, steps, run.samples(),
                              [&](const Bank& bank) { return log_densities(bank, run, target.filter); });
  }
  sum *= static_cast<double>(target.recording.transitions(Role::train)) /
         static_cast<double>(recording.transitions(Role::train));
  if (target.prior) sum += prior_information(around, *target.prior);
  return sum;
}

Bank with_complete_errors(const TrainingTransitions& transitions, const ModePosterior& posterior,
                          const SwitchingPrior& prior, Bank bank) {
  const Index n = bank.structure.states, p = prior.mean.size();
  const std::vector<RegressionSums> sums = sums_of_modes(transitions, posterior, prior.mean);
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    Mode& mode = bank.modes[j];
    const std::optional<Eigen::MatrixXd> Q_inverse = definite_inverse(mode.Q.topLeftCorner(n, n));
    const auto covariance =
        Q_inverse ? definite_inverse(Eigen::kroneckerProduct(*Q_inverse, sums[j].G).eval() + prior.information)
                  : std::nullopt;
    mode.parameter_covariance = covariance ? *covariance : Eigen::MatrixXd::Constant(p, p, not_a_number);
    mode.standard_error = mode.parameter_covariance.diagonal().cwiseSqrt();
    const double weight = std::max(sums[j].weight, std::numeric_limits<double>::min());
    const Eigen::VectorXd variance = mode.Q.diagonal();
    mode.Q_standard_error =
        ((variance * variance.transpose()).array() + mode.Q.array().square()).sqrt() / std::sqrt(weight);
  }
  const Eigen::ArrayXXd T = bank.transition.matrix().array();
  const Eigen::ArrayXd rows = posterior.switches.rowwise().sum().array() + 1.0;
  bank.transition_standard_error = ((T * (1.0 - T)).colwise() / rows).sqrt().matrix();
  return bank;
}

FreeParameters all_parameters(const Bank& bank, bool estimate_R, const Eigen::VectorXd& least_R) {
  FreeParameters free;
  free.theta_unit.resize(bank.structure.parameters(), bank.motion_of(bank.mode_count() - 1) + 1);
  for (Index j = 0; j < bank.mode_count(); ++j)
    free.theta_unit.col(bank.motion_of(j)) = bank.modes[j].standard_error.unaryExpr([](double error) {
      // NaN: the data do not determine this parameter
      return std::isnan(error) ? 1.0 : std::max(error, std::sqrt(std::numeric_limits<double>::min()));
    });
  if (estimate_R) free.R.resize(bank.R.rows());
  std::iota(free.R.begin(), free.R.end(), Index{0});
  if (least_R.size() > 0) free.least_R = least_R.cwiseMax(bank.rounding_variance());
  free.transition = bank.mode_count() > 1;
  return free;
}

Bank with_standard_errors(const LikelihoodTarget& target, const FreeParameters& free, Bank bank) {
  if (!free.R.empty())
    bank.R_standard_error = Eigen::VectorXd::Constant(bank.R.rows(), not_a_number).asDiagonal().toDenseMatrix();
  const BankCoordinates around(bank, free);
  const std::optional<Eigen::MatrixXd> covariance = observed_covariance(target, around);
  if (!covariance) return bank;
  const Eigen::VectorXd error = covariance->diagonal().cwiseSqrt();
  const Index n = bank.structure.states, p = free.theta_unit.rows(), K = bank.mode_count();
  Index at = 0;
  for (Index j = 0; j < K; ++j) {
    Mode& mode = bank.modes[j];
    mode.parameter_covariance = covariance->block(at, at, p, p);
    mode.standard_error = error.segment(at, p);
    at += p;
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a) mode.Q_standard_error(a, b) = mode.Q_standard_error(b, a) = error(at++);
    if (!free.transition) continue;
    bank.transition_standard_error.row(j) = error.segment(at, K);
    at += K;
  }
  if (!free.R.empty()) bank.R_standard_error = error.tail(std::ssize(free.R)).asDiagonal().toDenseMatrix();
  return bank;
}

}  // namespace modebank
