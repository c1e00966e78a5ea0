#include "filter/learn/switching/regression.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <unsupported/Eigen/KroneckerProduct>
#include <utility>

#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/log_two_pi.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Share of the largest information that is added in every direction of theta, so that the information of one
/// transition is definite.
constexpr double information_share = 1e-8;
constexpr double stay_of_start = 0.95;  // diagonal of T of a start from stretches, equal to BankOptions::stay

/// log N(r_k; 0, Q_j) of every transition under every mode, N x K; 0 where the transition is not usable.
Eigen::MatrixXd densities_of_modes(const TrainingTransitions& transitions, const SwitchingRegression& model) {
  Eigen::MatrixXd log_density(transitions.count(), model.modes());
  tbb::parallel_for(Index{0}, model.modes(), [&](Index j) {
    const Eigen::MatrixXd& Q = model.Q[j];
    const auto n = static_cast<double>(Q.rows());
    const Eigen::MatrixXd r = transitions.data.increments -
                              transitions.data.regressors * coefficients(transitions.structure, model.theta.col(j));
    const Eigen::MatrixXd whitened = Cholesky(Q).whiten(Eigen::MatrixXd(r.transpose()));
    const double constant = n * log_two_pi + log_determinant(Q);
    const Eigen::ArrayXd of_mode = -0.5 * (whitened.colwise().squaredNorm().array() + constant).transpose();
    log_density.col(j) = (transitions.usable.array() > 0.0).select(of_mode, 0.0);
  });
  return log_density;
}

/// Forward-backward algorithm over the rows of one run after another. Each step is scaled by the largest density of a
/// possible mode (log domain).
class RunSmoother {
 public:
  RunSmoother(const SwitchingRegression& model, const TrainingTransitions& transitions)
      : model_(model),
        transitions_(transitions),
        log_density_(densities_of_modes(transitions, model)),
        transition_(model.modes(), model.logit) {}

  /// Goes forward over a run from its first usable transition, where the filter starts, too.
  void forward(const RunRows& run) {
    const Index K = model_.modes();
    first_ = run.first;
    while (first_ < run.first + run.count && transitions_.usable(first_) == 0.0) ++first_;
    const Index count = run.first + run.count - first_;
    density_.resize(K, count);
    filtered_.resize(K, count + 1);
    scale_.resize(count);
    log_scale_.resize(count);
    filtered_.col(0) = model_.initial;
    for (Index k = 0; k < count; ++k) {
      const auto of_step = log_density_.row(first_ + k).transpose().array();
      auto filtered = filtered_.col(k + 1);
      filtered.noalias() = transition_of(first_ + k).transpose() * filtered_.col(k);
      const auto possible = filtered.array() > 0.0;
      const double largest = possible.select(of_step, -std::numeric_limits<double>::infinity()).maxCoeff();
      density_.col(k) = possible.select((of_step - largest).exp(), 0.0);
      filtered.array() *= density_.col(k).array();
      scale_(k) = filtered.sum();
      filtered /= scale_(k);
      log_scale_(k) = largest + std::log(scale_(k));
    }
  }

  /// Sets log p(transition | previous transitions) of the run's rows.
  void predict(Eigen::VectorXd& log_density) const { log_density.segment(first_, log_scale_.size()) = log_scale_; }

  /// Adds the run to the posterior's sums and fills its rows.
  void backward(ModePosterior& posterior) {
    if (scale_.size() == 0) return;
    const Index K = model_.modes();
    Eigen::VectorXd later = Eigen::VectorXd::Ones(K), weighted(K);
    Eigen::MatrixXd pairs(K, K);
    for (Index k = scale_.size() - 1; k >= 0; --k) {
      posterior.probability.row(first_ + k) = filtered_.col(k + 1).cwiseProduct(later);
      weighted = density_.col(k).cwiseProduct(later) / scale_(k);
      const Eigen::MatrixXd& T = transition_of(first_ + k);
      pairs.noalias() = filtered_.col(k) * weighted.transpose();
      pairs.array() *= T.array();
      posterior.switches += pairs;
      if (!model_.logit.empty()) posterior.pairs.col(first_ + k) = pairs.reshaped();
      later.noalias() = T * weighted;
    }
    posterior.first += model_.initial.cwiseProduct(later);
    posterior.log_likelihood += log_scale_.sum();
  }

 private:
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
  Eigen::MatrixXd log_density_;  ///< N x K
  TransitionWorkspace transition_;
  Index first_ = 0;                     ///< row of the run's first usable transition
  Eigen::MatrixXd density_, filtered_;  ///< K rows; column k of filtered_ is before transition k
  Eigen::VectorXd scale_, log_scale_;
};

/// The best theta of the modes `first` to `end` - 1 given their Q and the prior; empty if a Q is not definite.
std::optional<Eigen::VectorXd> best_theta(const std::vector<RegressionSums>& sums, const SwitchingPrior& prior,
                                          const SwitchingRegression& model, Index first, Index end) {
  Eigen::MatrixXd information = prior.information;
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(prior.mean.size());
  for (Index j = first; j < end; ++j) {
    const std::optional<Eigen::MatrixXd> Q_inverse = definite_inverse(model.Q[j]);
    if (!Q_inverse) return std::nullopt;
    information += Eigen::kroneckerProduct(*Q_inverse, sums[j].G).eval();
    const Eigen::MatrixXd of_mode = sums[j].H * *Q_inverse;
    pull += of_mode.reshaped();
  }
  const Cholesky factor(information);  // an LDLT of 128 coefficients takes four times the time
  return prior.mean + (factor.definite() ? factor.solve(pull) : solve_semidefinite(information, pull));
}

/// Raises the likelihood over Q, given each mode's scatter of residuals and its weight. With noise levels, Q_ml = f_l
/// V_m: V given f, then f given V.
void raise_noise(const std::vector<Eigen::MatrixXd>& scatter, const Eigen::VectorXd& weight,
                 SwitchingRegression& model) {
  const Index K = model.modes(), L = model.noise_levels;
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(L), distance = Eigen::VectorXd::Zero(L), size = distance;
  for (Index l = 1; l < L; ++l) factor(l) = model.Q[l](0, 0) / model.Q[0](0, 0);
  for (Index first = 0; first < K; first += L) {
    Eigen::MatrixXd V = Eigen::MatrixXd::Zero(scatter[first].rows(), scatter[first].cols());
    for (Index l = 0; l < L; ++l) V += scatter[first + l] / factor(l);
    V /= weight.segment(first, L).sum();
    for (Index l = 0; l < L; ++l) {
      model.Q[first + l] = V;
      if (L > 1) distance(l) += solve_semidefinite(V, scatter[first + l]).trace();
      size(l) += static_cast<double>(V.rows()) * weight(first + l);
    }
  }
  for (Index j = 0; L > 1 && j < K; ++j) model.Q[j] *= distance(j % L) / size(j % L);
}

Eigen::MatrixXd rows_sum_to_one(const Eigen::MatrixXd& counts) {
  return counts.array().colwise() / counts.array().rowwise().sum();
}

/// Standard deviations of the logit's weights, d: `width` over the regressors' standard deviations. The weight of a
/// regressor that is constant up to rounding has no effect.
Eigen::VectorXd weight_deviations(const TrainingTransitions& transitions, double width) {
  const Eigen::VectorXd mean = no_effect(transitions, 1).reference;
  const Eigen::MatrixXd z = transitions.data.regressors.leftCols(mean.size()).rowwise() - mean.transpose();
  const Eigen::ArrayXd sd = (z.cwiseAbs2().transpose() * transitions.usable / transitions.usable.sum()).cwiseSqrt();
  return (sd > 1e-12 * mean.array().abs()).select(width / sd, width);
}

}  // namespace

SwitchingRegression switching_model(const Bank& bank) {
  const Index n = bank.structure.states;
  SwitchingRegression model{Eigen::MatrixXd(bank.structure.parameters(), bank.mode_count()),
                            {},
                            bank.transition.matrix(),
                            bank.initial_probability,
                            bank.transition_logit,
                            bank.motion,
                            bank.noise_levels};
  for (Index j = 0; j < bank.mode_count(); ++j) {
    model.theta.col(j) = bank.theta(j);
    model.Q.push_back(bank.modes[j].Q.topLeftCorner(n, n));
  }
  if (!model.logit.empty()) model.logit.reference -= bank.structure.acting_centre();
  return model;
}

Bank with_modes(Bank bank, const SwitchingRegression& model) {
  bank.modes.clear();
  const Index p = bank.structure.parameters(), K = model.modes();
  for (Index j = 0; j < K; ++j)
    bank.modes.push_back(make_mode(bank.structure, model.theta.col(j), model.Q[j], Eigen::MatrixXd::Zero(p, p),
                                   Eigen::VectorXd::Constant(p, not_a_number), 1.0 / static_cast<double>(K)));
  bank.motion = model.motion;
  bank.noise_levels = model.noise_levels;
  bank.transition = TransitionMatrix(model.transition);
  bank.transition_logit = model.logit;
  if (!model.logit.empty()) bank.transition_logit.reference += bank.structure.acting_centre();
  bank.initial_probability = model.initial;
  return bank;
}

ModePosterior smooth_modes(const TrainingTransitions& transitions, const SwitchingRegression& model) {
  const Index K = model.modes();
  ModePosterior posterior{Eigen::MatrixXd::Zero(transitions.count(), K), Eigen::MatrixXd::Zero(K, K),
                          Eigen::VectorXd::Zero(K)};
  if (!model.logit.empty()) posterior.pairs.setZero(K * K, transitions.count());
  RunSmoother smoother(model, transitions);
  for (const RunRows& run : transitions.runs) {
    smoother.forward(run);
    smoother.backward(posterior);
  }
  return posterior;
}

Eigen::VectorXd predictive_log_densities(const TrainingTransitions& transitions, const SwitchingRegression& model) {
  Eigen::VectorXd log_density = Eigen::VectorXd::Zero(transitions.count());
  RunSmoother smoother(model, transitions);
  for (const RunRows& run : transitions.runs) {
    smoother.forward(run);
    smoother.predict(log_density);
  }
  return log_density;
}

std::vector<RegressionSums> sums_of_modes(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                          const Eigen::VectorXd& theta) {
  const Eigen::MatrixXd& X = transitions.data.regressors;
  const Eigen::MatrixXd r = transitions.data.increments - X * coefficients(transitions.structure, theta);
  std::vector<RegressionSums> sums(posterior.probability.cols());
  tbb::parallel_for(Index{0}, posterior.probability.cols(), [&](Index j) {
    sums[j] = regression_sums(X, posterior.probability.col(j).cwiseProduct(transitions.usable), r);
  });
  return sums;
}

SwitchingPrior switching_prior(const TrainingTransitions& transitions, const GlobalModel& global,
                               const Eigen::VectorXd& prior_sd, double noise_transitions, double logit_width) {
  SwitchingPrior prior{global.theta, {}, global.residual_covariance, noise_transitions, label_count_smoothing};
  prior.noise.diagonal() = prior.noise.diagonal().unaryExpr(&positive_variance) * (1.0 + 1e-9);
  if (logit_width > 0.0) prior.weight_sd = weight_deviations(transitions, logit_width);
  if (prior_sd.size() > 0) {
    prior.information = prior_sd.array().square().inverse().matrix().asDiagonal();
    return prior;
  }
  // The average information of one transition. A share of its largest entry is added to make it definite.
  const Eigen::MatrixXd& X = transitions.data.regressors;
  const Eigen::MatrixXd G = X.transpose() * transitions.usable.asDiagonal() * X / transitions.usable.sum();
  const std::optional<Eigen::MatrixXd> Q_inverse = definite_inverse(prior.noise);
  if (!Q_inverse)
    throw DataError(
        "the states' residuals in the training runs are linearly dependent: one state follows from the others; leave "
        "it out of data.state");
  prior.information = Eigen::kroneckerProduct(*Q_inverse, G);
  prior.information.diagonal().array() += information_share * prior.information.diagonal().maxCoeff();
  return prior;
}

std::pair<Eigen::MatrixXd, Eigen::MatrixXd> chains_of(const Eigen::MatrixXd& T, Index noise_levels) {
  const Index L = noise_levels, M = T.rows() / L;
  Eigen::MatrixXd of_motions = Eigen::MatrixXd::Zero(M, M), of_levels = Eigen::MatrixXd::Zero(L, L);
  for (Index i = 0; i < T.rows(); ++i)
    for (Index j = 0; j < T.cols(); ++j) {
      of_motions(i / L, j / L) += T(i, j);
      of_levels(i % L, j % L) += T(i, j);
    }
  return {rows_sum_to_one(of_motions), rows_sum_to_one(of_levels)};
}

double log_prior(const SwitchingPrior& prior, const SwitchingRegression& model) {
  double sum = 0.0;
  for (Index first = 0; first < model.modes(); first = model.end_of_motion(first)) {
    const Eigen::VectorXd difference = model.theta.col(first) - prior.mean;
    sum -= 0.5 * difference.dot(prior.information * difference);
  }
  for (const Eigen::MatrixXd& Q : model.Q) {
    const std::optional<Eigen::MatrixXd> inverse = definite_inverse(Q);
    if (!inverse) return -std::numeric_limits<double>::infinity();
    sum -= 0.5 * prior.noise_transitions * (log_determinant(Q) + inverse->cwiseProduct(prior.noise).sum());
  }
  if (!model.logit.empty())
    sum -= 0.5 * (model.logit.weights * prior.weight_sd.cwiseInverse().asDiagonal()).squaredNorm();
  if (prior.counts > 0.0)
    sum += prior.counts * (model.transition.array().log().sum() + model.initial.array().log().sum());
  return sum;
}

SwitchingRegression maximise(const TrainingTransitions& transitions, const ModePosterior& posterior,
                             const SwitchingPrior& prior, const SwitchingEmOptions& options,
                             SwitchingRegression model) {
  const std::vector<RegressionSums> sums = sums_of_modes(transitions, posterior, prior.mean);
  const Index K = model.modes();
  std::vector<Eigen::MatrixXd> scatter(sums.size());
  Eigen::VectorXd weight(K);
  for (int i = 0; i < options.alternations; ++i) {
    // If a Q is singular, theta does not change. The objective is then minus infinity; such a fit is never chosen.
    for (Index first = 0, end = 0; first < K; first = end) {
      end = model.end_of_motion(first);
      if (const auto theta = best_theta(sums, prior, model, first, end))
        model.theta.middleCols(first, end - first).colwise() = *theta;
    }
    for (Index j = 0; j < K; ++j) {
      const Eigen::MatrixXd change = coefficients(transitions.structure, model.theta.col(j) - prior.mean);
      scatter[j] = sums[j].scatter_after(change) + prior.noise_transitions * prior.noise;
      weight(j) = sums[j].weight + prior.noise_transitions;
    }
    raise_noise(scatter, weight, model);
  }
  model.initial = posterior.first.array() + prior.counts;
  model.initial /= model.initial.sum();
  const Eigen::MatrixXd counts = posterior.switches.array() + prior.counts;
  if (!model.logit.empty()) {
    raise_switching(transitions, posterior, prior, model);
  } else if (model.noise_levels > 1) {
    const auto [of_motions, of_levels] = chains_of(counts, model.noise_levels);
    model.transition = Eigen::kroneckerProduct(of_motions, of_levels);
  } else {
    model.transition = rows_sum_to_one(counts);
  }
  return model;
}

void iterate(const TrainingTransitions& transitions, const SwitchingPrior& prior, const SwitchingEmOptions& options,
             Index iterations, SwitchingFit& fit) {
  if (fit.objective.empty()) fit.posterior = smooth_modes(transitions, fit.model);
  const auto objective = [&] { return fit.posterior.log_likelihood + log_prior(prior, fit.model); };
  for (Index i = 0; i < iterations && !fit.converged; ++i) {
    fit.objective.push_back(objective());
    fit.model = maximise(transitions, fit.posterior, prior, options, std::move(fit.model));
    fit.posterior = smooth_modes(transitions, fit.model);
    const double gain = objective() - fit.objective.back();
    // The first step moves from the optimum of the start to that of the prior. So the objective may fall in this step.
    fit.converged = fit.objective.size() > 1 && !(gain >= options.tolerance * static_cast<double>(transitions.count()));
  }
}

SwitchingRegression start_from_stretches(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                         Index modes, Index length, std::uint64_t seed, Index index) {
  std::mt19937_64 generator = make_generator(seed, "refine", static_cast<std::uint64_t>(index));
  const Index N = transitions.count();
  length = std::clamp(length, Index{1}, N);
  std::vector<Index> slots(std::max(N / length, Index{1}));
  std::iota(slots.begin(), slots.end(), Index{0});
  for (std::size_t i = slots.size() - 1; i > 0; --i) std::swap(slots[i], slots[generator() % (i + 1)]);
  ModePosterior posterior{Eigen::MatrixXd::Zero(N, modes), Eigen::MatrixXd::Zero(modes, modes),
                          Eigen::VectorXd::Zero(modes)};
  for (Index j = 0; j < modes; ++j)
    posterior.probability.col(j).segment(length * slots[j % slots.size()], length).setOnes();
  const std::vector<Eigen::MatrixXd> Q(modes, prior.noise);
  SwitchingRegression model = maximise(transitions, posterior, prior, {}, {prior.mean.replicate(1, modes), Q, {}, {}});
  model.transition = TransitionMatrix::sticky(modes, stay_of_start).matrix();
  model.initial = Eigen::VectorXd::Constant(modes, 1.0 / static_cast<double>(modes));
  return model;
}

}  // namespace modebank
