#include "filter/switching_regression.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/KroneckerProduct>

#include "filter/definite_inverse.hpp"
#include "mixture/component_merge.hpp"

namespace modebank {
namespace {

constexpr int alternations = 3;  // of theta and Q in one maximisation; each raises the objective

/// log N(r_k; 0, Q) of every transition of one mode, to the power of its sample weight.
Eigen::VectorXd log_densities(const TrainingTransitions& transitions, const Eigen::VectorXd& theta,
                              const Eigen::MatrixXd& Q) {
  const Eigen::MatrixXd r =
      transitions.data.increments - transitions.data.regressors * coefficients(transitions.structure, theta);
  const Eigen::LLT<Eigen::MatrixXd> factor(Q);
  const Eigen::MatrixXd whitened = factor.matrixL().solve(r.transpose());
  const double constant = static_cast<double>(Q.rows()) * std::log(2.0 * std::numbers::pi) + log_determinant(Q);
  return (-0.5 * (whitened.colwise().squaredNorm().array() + constant)).transpose() * transitions.usable.array();
}

/// Forward-backward over the rows of one run; adds to the posterior's sums and fills its rows.
class RunSmoother {
 public:
  RunSmoother(const SwitchingRegression& model, const Eigen::MatrixXd& log_density)
      : model_(model), log_density_(log_density) {}

  /// Leading transitions that are not usable are left out, as the filter starts after them.
  void add(RunRows rows, const Eigen::VectorXd& usable, ModePosterior& posterior) {
    while (rows.count > 0 && usable(rows.first) == 0.0) {
      ++rows.first;
      --rows.count;
    }
    if (rows.count == 0) return;
    forward(rows, posterior);
    backward(rows, posterior);
  }

 private:
  void forward(const RunRows& rows, ModePosterior& posterior) {
    const Index K = model_.modes();
    density_.resize(K, rows.count);
    filtered_.resize(K, rows.count);
    scale_.resize(rows.count);
    for (Index k = 0; k < rows.count; ++k) {
      const auto of_step = log_density_.row(rows.first + k).transpose();
      const double largest = of_step.maxCoeff();
      density_.col(k) = (of_step.array() - largest).exp();
      filtered_.col(k).noalias() = model_.transition.transpose() * before(k);
      filtered_.col(k).array() *= density_.col(k).array();
      scale_(k) = filtered_.col(k).sum();
      filtered_.col(k) /= scale_(k);
      posterior.log_likelihood += largest + std::log(scale_(k));
    }
  }

  void backward(const RunRows& rows, ModePosterior& posterior) {
    const Index K = model_.modes();
    Eigen::VectorXd later = Eigen::VectorXd::Ones(K), weighted(K);
    Eigen::MatrixXd pairs = Eigen::MatrixXd::Zero(K, K);
    for (Index k = rows.count - 1; k >= 0; --k) {
      posterior.probability.row(rows.first + k) = filtered_.col(k).cwiseProduct(later);
      weighted = density_.col(k).cwiseProduct(later) / scale_(k);
      pairs.noalias() += before(k) * weighted.transpose();
      later.noalias() = model_.transition * weighted;
    }
    posterior.switches += pairs.cwiseProduct(model_.transition);
    posterior.first += model_.initial.cwiseProduct(later);
  }

  /// Mode probabilities that the step to transition k starts from.
  Eigen::VectorXd before(Index k) const { return k > 0 ? filtered_.col(k - 1) : model_.initial; }

  const SwitchingRegression& model_;
  const Eigen::MatrixXd& log_density_;
  Eigen::MatrixXd density_, filtered_;
  Eigen::VectorXd scale_;
};

class Maximiser {
 public:
  Maximiser(const LinearStructure& structure, const SwitchingSums& sums, const SwitchingPrior& prior,
            SwitchingRegression& model)
      : structure_(structure), sums_(sums), prior_(prior), model_(model) {}

  void raise(SharedParts shared) {
    for (int i = 0; i < alternations; ++i) {
      if (shared == SharedParts::theta) set_common_theta();
      for (Index j = 0; j < model_.modes(); ++j) {
        if (shared != SharedParts::theta) set_theta(j);
        noise(j) = with_prior(scatter(j), at(j).transitions);
      }
      if (shared == SharedParts::noise) set_common_noise();
    }
  }

 private:
  Eigen::MatrixXd& noise(Index j) { return model_.Q[static_cast<std::size_t>(j)]; }
  const ModeSums& at(Index j) const { return sums_.modes[static_cast<std::size_t>(j)]; }

  void set_theta(Index j) {
    const Eigen::MatrixXd Q_inverse = definite_inverse(noise(j));
    const Eigen::MatrixXd information = Eigen::kroneckerProduct(Q_inverse, at(j).G).eval() + prior_.information;
    const Eigen::MatrixXd pull = at(j).H * Q_inverse;
    model_.theta.col(j) = prior_.mean + information.ldlt().solve(pull.reshaped());
  }

  void set_common_theta() {
    Eigen::MatrixXd information = prior_.information;
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(prior_.mean.size());
    for (Index j = 0; j < model_.modes(); ++j) {
      const Eigen::MatrixXd Q_inverse = definite_inverse(noise(j));
      information += Eigen::kroneckerProduct(Q_inverse, at(j).G).eval();
      const Eigen::MatrixXd of_mode = at(j).H * Q_inverse;
      pull += of_mode.reshaped();
    }
    model_.theta.colwise() = prior_.mean + information.ldlt().solve(pull);
  }

  /// Sum of squares about the mode's own theta.
  Eigen::MatrixXd scatter(Index j) const {
    const Eigen::MatrixXd D = coefficients(structure_, model_.theta.col(j) - prior_.mean);
    const Eigen::MatrixXd cross = D.transpose() * at(j).H;
    return at(j).S - cross - cross.transpose() + D.transpose() * at(j).G * D;
  }

  Eigen::MatrixXd with_prior(const Eigen::MatrixXd& sum, double transitions) const {
    return (sum + prior_.noise_transitions * prior_.noise) / (transitions + prior_.noise_transitions);
  }

  void set_common_noise() {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(prior_.noise.rows(), prior_.noise.cols());
    double count = 0.0;
    for (Index j = 0; j < model_.modes(); ++j) {
      sum += scatter(j);
      count += at(j).transitions;
    }
    for (Eigen::MatrixXd& Q : model_.Q) Q = with_prior(sum, count);
  }

  const LinearStructure& structure_;
  const SwitchingSums& sums_;
  const SwitchingPrior& prior_;
  SwitchingRegression& model_;
};

}  // namespace

ModePosterior smooth_modes(const TrainingTransitions& transitions, const SwitchingRegression& model) {
  const Index K = model.modes();
  Eigen::MatrixXd log_density(transitions.count(), K);
  tbb::parallel_for(Index{0}, K, [&](Index j) {
    log_density.col(j) = log_densities(transitions, model.theta.col(j), model.Q[static_cast<std::size_t>(j)]);
  });
  ModePosterior posterior{Eigen::MatrixXd::Zero(transitions.count(), K), Eigen::MatrixXd::Zero(K, K),
                          Eigen::VectorXd::Zero(K)};
  RunSmoother smoother(model, log_density);
  for (const RunRows& rows : transitions.runs) smoother.add(rows, transitions.usable, posterior);
  return posterior;
}

SwitchingSums sum_transitions(const TrainingTransitions& transitions, const ModePosterior& posterior,
                              const SwitchingPrior& prior) {
  const Eigen::MatrixXd& X = transitions.data.regressors;
  const Eigen::MatrixXd r = transitions.data.increments - X * coefficients(transitions.structure, prior.mean);
  SwitchingSums sums{std::vector<ModeSums>(static_cast<std::size_t>(posterior.probability.cols())), posterior.switches,
                     posterior.first};
  tbb::parallel_for(Index{0}, posterior.probability.cols(), [&](Index j) {
    const Eigen::VectorXd g = posterior.probability.col(j).cwiseProduct(transitions.usable);
    const Eigen::MatrixXd weighted = g.asDiagonal() * X;
    sums.modes[static_cast<std::size_t>(j)] = {weighted.transpose() * X, weighted.transpose() * r,
                                               r.transpose() * g.asDiagonal() * r, g.sum()};
  });
  return sums;
}

void maximise(const LinearStructure& structure, const SwitchingSums& sums, const SwitchingPrior& prior,
              SharedParts shared, SwitchingRegression& model) {
  Maximiser(structure, sums, prior, model).raise(shared);
  const Eigen::MatrixXd counts = sums.switches.array() + prior.counts;
  for (Index i = 0; i < model.modes(); ++i) {
    const double row = counts.row(i).sum();
    if (row > 0.0) model.transition.row(i) = counts.row(i) / row;
  }
  model.initial = sums.first.array() + prior.counts;
  model.initial /= model.initial.sum();
}

std::vector<Eigen::MatrixXd> parameter_covariances(const SwitchingSums& sums, const SwitchingPrior& prior,
                                                   const SwitchingRegression& model) {
  std::vector<Eigen::MatrixXd> covariances;
  for (std::size_t j = 0; j < sums.modes.size(); ++j)
    covariances.push_back(definite_inverse(
        Eigen::kroneckerProduct(definite_inverse(model.Q[j]), sums.modes[j].G).eval() + prior.information));
  return covariances;
}

double log_prior(const SwitchingPrior& prior, SharedParts shared, const SwitchingRegression& model) {
  const Index thetas = shared == SharedParts::theta ? 1 : model.modes();
  const Index noises = shared == SharedParts::noise ? 1 : model.modes();
  double sum = 0.0;
  for (Index j = 0; j < thetas; ++j) {
    const Eigen::VectorXd difference = model.theta.col(j) - prior.mean;
    sum -= 0.5 * difference.dot(prior.information * difference);
  }
  for (Index j = 0; j < noises; ++j) {
    const Eigen::MatrixXd& Q = model.Q[static_cast<std::size_t>(j)];
    sum -= 0.5 * prior.noise_transitions * (log_determinant(Q) + (definite_inverse(Q) * prior.noise).trace());
  }
  if (prior.counts > 0.0)
    sum += prior.counts * (model.transition.array().log().sum() + model.initial.array().log().sum());
  return sum;
}

}  // namespace modebank
