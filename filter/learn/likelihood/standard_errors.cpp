#include "filter/learn/likelihood/standard_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "filter/learn/likelihood/information.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

constexpr double weight_unit_share = 0.1;  // as a share of the prior's standard deviation

// Standard errors need an accuracy of a few per cent. Their relative error decreases with the square root of the number
// of samples.
constexpr double most_numbers = 4e6;  // number of samples times number of coordinates; 32 MB
constexpr Index fewest_samples = 2000, most_samples = 20000;

/// Covariance of the parameters in the order of ParameterPlaces, and the distance from their values to the maximum.
struct Observed {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd newton_step;
};

/// Adds the gradient of the prior on the logit's weights, the last coordinates.
void add_weights_gradient(const BankCoordinates& around, const SwitchingPrior& prior, Eigen::VectorXd& gradient) {
  const ParameterPlaces at = around.places();
  for (Index a = 0; a < at.regressors; ++a)
    gradient.segment(around.size() - (at.regressors - a) * at.modes, at.modes) -=
        around.weight_unit()(a) / (prior.weight_sd(a) * prior.weight_sd(a)) *
        around.origin().transition_logit.weights.col(a);
}

/// Whether states count as measured exactly because R is at its bound.
bool is_exact(const BankCoordinates& around) {
  const Bank& bank = around.origin();
  return around.places().outputs == 0 && (bank.R.diagonal().array() <= around.least_R().array()).all() &&
         !bank.is_quantised() && bank.terms.empty();
}

/// Empty if the information matrix is singular.
std::optional<Observed> observe(const LikelihoodTarget& target, const BankCoordinates& around) {
  const Index most =
      std::clamp(static_cast<Index>(most_numbers / static_cast<double>(around.size())), fewest_samples, most_samples);
  const InformationSamples samples(target.recording, most);
  const Eigen::VectorXd steps = Eigen::VectorXd::Constant(around.size(), difference_step);
  const Recording& recording = samples.part ? *samples.part : target.recording;
  const SampleGradients gradients =
      is_exact(around) ? exact_sample_gradients(around, steps,
                                                gather_training_transitions(recording, around.origin().structure,
                                                                            around.origin().noise_factor))
                       : sample_gradients(around, steps, recording, target.filter);
  const Eigen::MatrixXd information = samples.factor * gradients.information + prior_information(around, *target.prior);
  if (!information.allFinite()) return std::nullopt;
  // Coordinates differ in scale by orders of magnitude, so the correlation matrix is factorised.
  const Eigen::VectorXd unit =
      information.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Cholesky factor(unit.asDiagonal() * information * unit.asDiagonal());
  if (!factor.definite()) return std::nullopt;
  const Eigen::MatrixXd root = factor.whiten(Eigen::MatrixXd(unit.asDiagonal() * around.jacobian().transpose()));
  Eigen::VectorXd gradient = samples.factor * gradients.sum;
  add_weights_gradient(around, *target.prior, gradient);
  const Eigen::VectorXd whitened = factor.whiten(Eigen::MatrixXd(unit.cwiseProduct(gradient)));
  Observed observed{root.transpose() * root, root.transpose() * whitened};
  if (!observed.covariance.allFinite() || !(observed.covariance.diagonal().minCoeff() > 0.0)) return std::nullopt;
  return observed;
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
  if (!bank.transition_logit.empty())
    bank.transition_weight_error.setConstant(bank.mode_count(), bank.transition_logit.weights.cols(), not_a_number);
  bank.transition_standard_error = ((T * (1.0 - T)).colwise() / rows).sqrt().matrix();
  if (with_R)
    bank.R_standard_error = Eigen::VectorXd::Constant(bank.R.rows(), not_a_number).asDiagonal().toDenseMatrix();
}

/// Whether the training runs contradict sharper borders between modes. The test doubles all log odds, which makes
/// borders twice as sharp and does not move them. If no sample lies near a border, the runs do not contradict, even if
/// the prior makes standard errors small.
bool against_harder_borders(const LikelihoodTarget& target, const Bank& bank) {
  constexpr double clearly = 1.92;  // nats: 95 % quantile of chi-square with one degree of freedom, halved
  Bank harder = bank;
  harder.transition_logit.weights *= 2.0;
  const Eigen::MatrixXd squared = bank.transition.matrix().cwiseAbs2();
  harder.transition = TransitionMatrix(squared.array().colwise() / squared.rowwise().sum().array());
  const LikelihoodTarget data_alone{target.recording, target.filter, std::nullopt};
  return data_alone.value(bank) - data_alone.value(harder) > clearly;
}

/// Standard errors of those weights of the logit that the data determine. If no sample lies on a mode's border, the
/// data only show that weights are large. The standard error of such a weight is then about the prior's standard
/// deviation, or the weight was still growing at the end of expectation-maximisation. Such errors become NaN.
Eigen::VectorXd determined(const Eigen::VectorXd& error, const Eigen::VectorXd& step, const Eigen::VectorXd& prior_sd) {
  constexpr double most = 0.5;  // limit on two shares: standard error / prior's standard deviation, and remaining step
                                // / standard error
  const bool all = (error.array() < most * prior_sd.array()).all() && (step.array().abs() < most * error.array()).all();
  return all ? error : Eigen::VectorXd::Constant(error.size(), not_a_number);
}

void set_observed_errors(const ParameterPlaces& at, const Observed& observed, const SwitchingPrior& prior, Bank& bank) {
  const Eigen::MatrixXd& covariance = observed.covariance;
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
    if (at.regressors > 0)
      bank.transition_weight_error.row(j) =
          determined(error.segment(at.weights(j), at.regressors),
                     observed.newton_step.segment(at.weights(j), at.regressors), prior.weight_sd)
              .transpose();
  }
  // The weights of a mode are relative to those of the other modes. If the weight of one mode is unknown, all are
  // unknown.
  if (!bank.transition_weight_error.allFinite()) bank.transition_weight_error.setConstant(not_a_number);
  if (at.outputs > 0) bank.R_standard_error = error.segment(at.R(), at.outputs).asDiagonal().toDenseMatrix();
}

}  // namespace

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
  if (!bank.transition_logit.empty()) free.weight_unit = weight_unit_share * prior.weight_sd;
  return free;
}

Bank with_standard_errors(const LikelihoodTarget& target, const FreeParameters& free, const SwitchingSums& complete,
                          Bank bank) {
  set_complete_errors(complete, *target.prior, !free.R.empty(), bank);
  const BankCoordinates around(bank, free);
  if (const auto observed = observe(target, around))
    set_observed_errors(around.places(), *observed, *target.prior, bank);
  if (!bank.transition_logit.empty() && !against_harder_borders(target, bank))
    bank.transition_weight_error.setConstant(not_a_number);
  return bank;
}

}  // namespace modebank
