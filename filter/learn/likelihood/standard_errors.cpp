#include "filter/learn/likelihood/standard_errors.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "filter/learn/left_out/folds.hpp"
#include "filter/step/bank_filter.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

// Step of central differences. Coordinates are in units of about their standard error, or are logarithms. The relative
// error of a difference is about 1e-4.
constexpr double difference_step = 1e-2;
constexpr double least_probability = 1e-100;  // smallest divisor whose square does not underflow

// Standard errors need an accuracy of a few per cent. Their relative error decreases with the square root of the number
// of samples.
constexpr double most_numbers = 4e6;  // number of samples times number of coordinates; 32 MB
constexpr Index fewest_samples = 2000, most_samples = 20000;

/// Central differences of `densities` of a bank: one row per sample, one column per coordinate. A row is zero if the
/// sample has no density.
template <class Densities>
Eigen::MatrixXd gradients(const BankCoordinates& around, const Eigen::VectorXd& steps, Index samples,
                          Densities densities) {
  Eigen::MatrixXd result(samples, around.size());
  tbb::parallel_for(Index{0}, around.size(), [&](Index c) {
    const Eigen::VectorXd step = steps(c) * Eigen::VectorXd::Unit(around.size(), c);
    result.col(c) = (densities(around.decode(step)) - densities(around.decode(-step))) / (2.0 * steps(c));
  });
  return result.array().isNaN().select(0.0, result);
}

/// Information by the switching regression. It requires exactly measured states (R = 0). The densities equal those of
/// the filter, but cost far less, especially with many lags.
Eigen::MatrixXd exact_information(const BankCoordinates& around, const Eigen::VectorXd& steps,
                                  const Recording& recording) {
  const TrainingTransitions transitions =
      gather_training_transitions(recording, around.origin().structure, around.origin().noise_factor);
  const Eigen::MatrixXd g = gradients(around, steps, transitions.count(), [&](const Bank& bank) {
    return predictive_log_densities(transitions, switching_model(bank));
  });
  return g.transpose() * g;
}

/// Inverse variances of Q and T by the prior alone. The prior on Q counts as a scatter of its number of transitions.
/// The prior on T counts as its number of switches, for every pair of modes. The most frequent switch of a row has no
/// coordinate of its own, because rows sum to one.
Eigen::VectorXd information_of_noise_and_switches(const BankCoordinates& around, const SwitchingPrior& prior) {
  const ParameterPlaces at = around.places();
  const Bank& bank = around.origin();
  const Index n = bank.structure.states;
  Eigen::VectorXd information = Eigen::VectorXd::Zero(at.size());
  for (Index j = 0; j < at.modes; ++j) {
    const Eigen::MatrixXd& Q = bank.modes[static_cast<std::size_t>(j)].Q;
    Index next = at.Q(j);
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a)
        information(next++) = (a == b ? 0.5 : 1.0) * prior.noise_transitions / (Q(a, a) * Q(b, b));
    if (!at.transition || at.modes == 1) continue;
    const Eigen::RowVectorXd row = bank.transition.matrix().row(j).cwiseMax(least_probability);
    Index largest = 0;
    row.maxCoeff(&largest);
    for (Index k = 0; k < at.modes; ++k)
      if (k != largest) information(at.T(j) + k) = prior.counts / row(k) / row(k);
  }
  return information;
}

/// Whether states count as measured exactly because R is at its bound.
bool is_exact(const BankCoordinates& around) {
  const Bank& bank = around.origin();
  return around.places().outputs == 0 && (bank.R.diagonal().array() <= around.least_R().array()).all() &&
         !bank.is_quantised() && bank.terms.empty();
}

/// Covariance of the parameters in the order of ParameterPlaces. Empty if the information matrix is singular.
std::optional<Eigen::MatrixXd> observed_covariance(const LikelihoodTarget& target, const BankCoordinates& around) {
  const Index most =
      std::clamp(static_cast<Index>(most_numbers / static_cast<double>(around.size())), fewest_samples, most_samples);
  const InformationSamples samples(target.recording, most);
  const Eigen::VectorXd steps = Eigen::VectorXd::Constant(around.size(), difference_step);
  const Recording& recording = samples.part ? *samples.part : target.recording;
  const Eigen::MatrixXd of_samples = is_exact(around)
                                         ? exact_information(around, steps, recording)
                                         : sample_gradients(around, steps, recording, target.filter).information;
  const Eigen::MatrixXd information = samples.factor * of_samples + prior_information(around, *target.prior);
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

/// Standard errors given the smoothed modes. Those of theta come from its posterior covariance, those of Q from the
/// variance of a normal scatter, (Q_ii Q_jj + Q_ij^2) / W, and those of T from a binomial distribution.
void set_complete_errors(const SwitchingSums& sums, const SwitchingPrior& prior, bool with_R, Bank& bank) {
  const std::vector<Eigen::MatrixXd> covariances = parameter_covariances(sums, prior, switching_model(bank));
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    Mode& mode = bank.modes[j];
    const double weight = std::max(sums.modes[j].weight, std::numeric_limits<double>::min());
    mode.parameter_covariance = covariances[j];
    mode.standard_error = mode.parameter_covariance.diagonal().cwiseSqrt();
    const Eigen::VectorXd variance = mode.Q.diagonal();
    mode.Q_standard_error =
        ((variance * variance.transpose()).array() + mode.Q.array().square()).sqrt() / std::sqrt(weight);
  }
  const Eigen::ArrayXXd T = bank.transition.matrix().array();
  const Eigen::ArrayXd rows = sums.switches.rowwise().sum().array() + 1.0;
  bank.transition_standard_error = ((T * (1.0 - T)).colwise() / rows).sqrt().matrix();
  if (with_R)
    bank.R_standard_error = Eigen::VectorXd::Constant(bank.R.rows(), not_a_number).asDiagonal().toDenseMatrix();
}

void set_observed_errors(const ParameterPlaces& at, const Eigen::MatrixXd& covariance, Bank& bank) {
  const Index n = bank.structure.states;
  const Eigen::VectorXd error = covariance.diagonal().cwiseSqrt();
  for (Index j = 0; j < at.modes; ++j) {
    Mode& mode = bank.modes[static_cast<std::size_t>(j)];
    mode.parameter_covariance = covariance.block(at.theta(j), at.theta(j), at.parameters, at.parameters);
    mode.standard_error = error.segment(at.theta(j), at.parameters);
    Index next = at.Q(j);
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a, ++next) mode.Q_standard_error(a, b) = mode.Q_standard_error(b, a) = error(next);
    if (at.transition) bank.transition_standard_error.row(j) = error.segment(at.T(j), at.modes);
  }
  if (at.outputs > 0) bank.R_standard_error = error.segment(at.R(), at.outputs).asDiagonal().toDenseMatrix();
}

}  // namespace

SampleGradients sample_gradients(const BankCoordinates& around, const Eigen::VectorXd& steps,
                                 const Recording& recording, const FilterOptions& filter) {
  SampleGradients result{Eigen::VectorXd::Zero(around.size()), Eigen::MatrixXd::Zero(around.size(), around.size())};
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train || run.samples() < 2) continue;
    const Eigen::MatrixXd g =
        gradients(around, steps, run.samples(), [&](const Bank& bank) { return log_densities(bank, run, filter); });
    result.sum += g.colwise().sum().transpose();
    result.information.noalias() += g.transpose() * g;
  }
  return result;
}

InformationSamples::InformationSamples(const Recording& recording, Index most)
    : part(learning_part(recording, most, 1)) {
  if (part)
    factor =
        static_cast<double>(recording.transitions(Role::train)) / static_cast<double>(part->transitions(Role::train));
}

Eigen::MatrixXd prior_information(const BankCoordinates& around, const SwitchingPrior& prior) {
  const ParameterPlaces at = around.places();
  const Eigen::MatrixXd J = around.jacobian();
  Eigen::MatrixXd information = J.transpose() * information_of_noise_and_switches(around, prior).asDiagonal() * J;
  const Index thetas = at.parameters == 0 ? 0 : around.has_one_theta() ? 1 : at.modes;
  for (Index j = 0; j < thetas; ++j) {
    const auto of_theta = J.middleRows(at.theta(j), at.parameters);
    information.noalias() += of_theta.transpose() * prior.information * of_theta;
  }
  return information;
}

FreeParameters all_parameters(const Bank& bank, const SwitchingSums& complete, const SwitchingPrior& prior,
                              bool one_theta, bool estimate_R, const Eigen::VectorXd& least_R) {
  const std::vector<Eigen::MatrixXd> covariances = parameter_covariances(complete, prior, switching_model(bank));
  FreeParameters free;
  free.theta_unit.resize(bank.structure.parameters(), one_theta ? 1 : bank.mode_count());
  for (Index j = 0; j < free.theta_unit.cols(); ++j)
    free.theta_unit.col(j) = covariances[static_cast<std::size_t>(j)].diagonal().unaryExpr([](double variance) {
      if (std::isnan(variance)) return 1.0;  // the data do not determine this parameter
      return std::sqrt(std::max(variance, std::numeric_limits<double>::min()));
    });
  if (estimate_R) free.R.resize(static_cast<std::size_t>(bank.R.rows()));
  std::iota(free.R.begin(), free.R.end(), Index{0});
  if (least_R.size() > 0) free.least_R = least_R.cwiseMax(bank.rounding_variance());
  free.transition = bank.mode_count() > 1;
  return free;
}

Bank with_standard_errors(const LikelihoodTarget& target, const FreeParameters& free, const SwitchingSums& complete,
                          Bank bank) {
  set_complete_errors(complete, *target.prior, !free.R.empty(), bank);
  const BankCoordinates around(bank, free);
  if (const auto covariance = observed_covariance(target, around))
    set_observed_errors(around.places(), *covariance, bank);
  return bank;
}

}  // namespace modebank
