#include "filter/learn/switching/regression.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <optional>
#include <unsupported/Eigen/KroneckerProduct>
#include <utility>

#include "filter/learn/from_mixture/bank.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/log_two_pi.hpp"
#include "ident/base/not_a_number.hpp"
#include "mixture/reduction.hpp"

namespace modebank {
namespace {

/// log N(r_k; 0, Q) of every transition under one mode; 0 where it is not usable.
Eigen::VectorXd log_densities(const TrainingTransitions& transitions, const Eigen::VectorXd& theta,
                              const Eigen::MatrixXd& Q) {
  const Eigen::MatrixXd r =
      transitions.data.increments - transitions.data.regressors * coefficients(transitions.structure, theta);
  const Eigen::MatrixXd whitened = Cholesky(Q).whiten(Eigen::MatrixXd(r.transpose()));
  const double constant = static_cast<double>(Q.rows()) * log_two_pi + log_determinant(Q);
  Eigen::ArrayXd log_density = -0.5 * (whitened.colwise().squaredNorm().array() + constant).transpose();
  if (transitions.log_noise_factor.size() > 0)  // density of the rows before they were divided by the noise factor
    log_density -= (transitions.usable.array() > 0.0)
                       .select(0.5 * static_cast<double>(Q.rows()) * transitions.log_noise_factor.array(), 0.0);
  return log_density * transitions.usable.array();
}

/// Densities of all modes, N x K.
Eigen::MatrixXd densities_of_modes(const TrainingTransitions& transitions, const SwitchingRegression& model) {
  Eigen::MatrixXd log_density(transitions.count(), model.modes());
  tbb::parallel_for(Index{0}, model.modes(), [&](Index j) {
    log_density.col(j) = log_densities(transitions, model.theta.col(j), model.Q[static_cast<std::size_t>(j)]);
  });
  return log_density;
}

/// Forward-backward algorithm over the rows of one run. Adds to the posterior's sums and fills its rows.
class RunSmoother {
 public:
  RunSmoother(const SwitchingRegression& model, const TrainingTransitions& transitions,
              const Eigen::MatrixXd& log_density)
      : model_(model), transitions_(transitions), log_density_(log_density), transition_(model.modes(), model.logit) {}

  void add(const RunRows& all, ModePosterior& posterior) {
    const RunRows rows = from_first_usable(all);
    if (rows.count == 0) return;
    forward(rows);
    posterior.log_likelihood += log_scale_.sum();
    backward(rows, posterior);
  }

  /// log p(transition | previous transitions) for the run's rows.
  void predict(const RunRows& all, Eigen::VectorXd& log_density) {
    const RunRows rows = from_first_usable(all);
    if (rows.count == 0) return;
    forward(rows);
    log_density.segment(rows.first, rows.count) = log_scale_;
  }

 private:
  /// The rows without unusable transitions at the beginning. The filter starts after these.
  RunRows from_first_usable(RunRows rows) const {
    while (rows.count > 0 && transitions_.usable(rows.first) == 0.0) {
      ++rows.first;
      --rows.count;
    }
    return rows;
  }

  void forward(const RunRows& rows) {
    const Index K = model_.modes();
    density_.resize(K, rows.count);
    filtered_.resize(K, rows.count);
    scale_.resize(rows.count);
    log_scale_.resize(rows.count);
    for (Index k = 0; k < rows.count; ++k) {
      const auto of_step = log_density_.row(rows.first + k).transpose();
      filtered_.col(k).noalias() = transition_of(rows.first + k).transpose() * before(k);
      const auto possible = filtered_.col(k).array() > 0.0;
      const double largest = possible.select(of_step.array(), -std::numeric_limits<double>::infinity()).maxCoeff();
      density_.col(k) = possible.select((of_step.array() - largest).exp(), 0.0);
      filtered_.col(k).array() *= density_.col(k).array();
      scale_(k) = filtered_.col(k).sum();
      filtered_.col(k) /= scale_(k);
      log_scale_(k) = largest + std::log(scale_(k));
    }
  }

  void backward(const RunRows& rows, ModePosterior& posterior) {
    const Index K = model_.modes();
    Eigen::VectorXd later = Eigen::VectorXd::Ones(K), weighted(K);
    Eigen::MatrixXd pairs(K, K);
    for (Index k = rows.count - 1; k >= 0; --k) {
      posterior.probability.row(rows.first + k) = filtered_.col(k).cwiseProduct(later);
      weighted = density_.col(k).cwiseProduct(later) / scale_(k);
      const Eigen::MatrixXd& T = transition_of(rows.first + k);
      pairs.noalias() = before(k) * weighted.transpose();
      pairs.array() *= T.array();
      posterior.switches += pairs;
      if (!model_.logit.empty()) posterior.pairs.col(rows.first + k) = pairs.reshaped();
      later.noalias() = T * weighted;
    }
    posterior.first += model_.initial.cwiseProduct(later);
  }

  /// Mode probabilities before the step to transition k.
  Eigen::VectorXd before(Index k) const { return k > 0 ? filtered_.col(k - 1) : model_.initial; }

  /// The transition matrix of a row; T itself if a sample is missing.
  const Eigen::MatrixXd& transition_of(Index row) {
    if (model_.logit.empty() || transitions_.usable(row) == 0.0) return model_.transition;
    const Index n = transitions_.structure.dimension();
    const auto phi = transitions_.data.regressors.row(row);
    return transition_at(model_.transition, model_.logit, phi.head(n),
                         phi.segment(n, transitions_.structure.acting_inputs()), transition_);
  }

  const SwitchingRegression& model_;
  const TrainingTransitions& transitions_;
  const Eigen::MatrixXd& log_density_;
  TransitionWorkspace transition_;
  Eigen::MatrixXd density_, filtered_;
  Eigen::VectorXd scale_, log_scale_;
};

}  // namespace

SwitchingRegression switching_model(const Bank& bank) {
  SwitchingRegression model;
  const Index n = bank.structure.states;
  model.theta.resize(bank.structure.parameters(), bank.mode_count());
  for (Index j = 0; j < bank.mode_count(); ++j) {
    model.theta.col(j) = bank.theta(j);
    model.Q.push_back(bank.modes[static_cast<std::size_t>(j)].Q.topLeftCorner(n, n));
  }
  model.transition = bank.transition.matrix();
  model.logit = bank.transition_logit;
  if (!model.logit.empty()) model.logit.reference -= bank.structure.acting_centre();
  model.initial = bank.initial_probability;
  return model;
}

Bank with_modes(const Bank& frame, const SwitchingRegression& model) {
  Bank bank = frame;
  bank.modes.clear();
  const Index p = bank.structure.parameters(), K = model.modes();
  for (Index j = 0; j < K; ++j)
    bank.modes.push_back(make_mode(bank.structure, model.theta.col(j), model.Q[static_cast<std::size_t>(j)],
                                   Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Constant(p, not_a_number),
                                   1.0 / static_cast<double>(K)));
  bank.transition = TransitionMatrix(model.transition);
  bank.transition_logit = model.logit;
  if (!model.logit.empty()) bank.transition_logit.reference += bank.structure.acting_centre();
  bank.initial_probability = model.initial;
  return bank;
}

ModePosterior smooth_modes(const TrainingTransitions& transitions, const SwitchingRegression& model) {
  const Index K = model.modes();
  const Eigen::MatrixXd log_density = densities_of_modes(transitions, model);
  ModePosterior posterior{Eigen::MatrixXd::Zero(transitions.count(), K), Eigen::MatrixXd::Zero(K, K),
                          Eigen::VectorXd::Zero(K)};
  if (!model.logit.empty()) posterior.pairs.setZero(K * K, transitions.count());
  RunSmoother smoother(model, transitions, log_density);
  for (const RunRows& rows : transitions.runs) smoother.add(rows, posterior);
  return posterior;
}

Eigen::VectorXd predictive_log_densities(const TrainingTransitions& transitions, const SwitchingRegression& model) {
  const Eigen::MatrixXd log_density = densities_of_modes(transitions, model);
  Eigen::VectorXd predictive = Eigen::VectorXd::Zero(transitions.count());
  RunSmoother smoother(model, transitions, log_density);
  for (const RunRows& rows : transitions.runs) smoother.predict(rows, predictive);
  return predictive;
}

SwitchingSums sum_transitions(const TrainingTransitions& transitions, const ModePosterior& posterior,
                              const SwitchingPrior& prior) {
  const Eigen::MatrixXd& X = transitions.data.regressors;
  const Eigen::MatrixXd r = transitions.data.increments - X * coefficients(transitions.structure, prior.mean);
  SwitchingSums sums{std::vector<RegressionSums>(static_cast<std::size_t>(posterior.probability.cols())),
                     posterior.switches, posterior.first};
  tbb::parallel_for(Index{0}, posterior.probability.cols(), [&](Index j) {
    const Eigen::VectorXd g = posterior.probability.col(j).cwiseProduct(transitions.usable);
    sums.modes[static_cast<std::size_t>(j)] = regression_sums(X, g, r);
  });
  return sums;
}

std::vector<Eigen::MatrixXd> parameter_covariances(const SwitchingSums& sums, const SwitchingPrior& prior,
                                                   const SwitchingRegression& model) {
  std::vector<Eigen::MatrixXd> covariances;
  for (std::size_t j = 0; j < sums.modes.size(); ++j) {
    covariances.push_back(Eigen::MatrixXd::Constant(prior.mean.size(), prior.mean.size(), not_a_number));
    const std::optional<Eigen::MatrixXd> Q_inverse = definite_inverse(model.Q[j]);
    if (!Q_inverse) continue;
    if (auto inverse =
            definite_inverse(Eigen::kroneckerProduct(*Q_inverse, sums.modes[j].G).eval() + prior.information))
      covariances.back() = std::move(*inverse);
  }
  return covariances;
}

double log_prior(const SwitchingPrior& prior, bool one_theta, const SwitchingRegression& model) {
  const Index thetas = one_theta ? 1 : model.modes();
  double sum = 0.0;
  for (Index j = 0; j < thetas; ++j) {
    const Eigen::VectorXd difference = model.theta.col(j) - prior.mean;
    sum -= 0.5 * difference.dot(prior.information * difference);
  }
  for (const Eigen::MatrixXd& Q : model.Q) {
    const std::optional<Eigen::MatrixXd> inverse = definite_inverse(Q);
    if (!inverse) return -std::numeric_limits<double>::infinity();
    sum -= 0.5 * prior.noise_transitions * (log_determinant(Q) + (*inverse * prior.noise).trace());
  }
  if (!model.logit.empty())
    sum -= 0.5 * (model.logit.weights * prior.weight_sd.cwiseInverse().asDiagonal()).squaredNorm();
  if (prior.counts > 0.0)
    sum += prior.counts * (model.transition.array().log().sum() + model.initial.array().log().sum());
  return sum;
}

}  // namespace modebank
