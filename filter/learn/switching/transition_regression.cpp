#include "filter/learn/switching/transition_regression.hpp"

#include <cmath>
#include <limits>

#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

constexpr double negligible_share = 1e-12;  // smallest weight for which a mode's transitions are counted

// ridge, as a share of the largest curvature; needed because adding a constant to a row of log T has no effect
constexpr double curvature_ridge = 1e-10;
constexpr int most_halvings = 30;

Index regressor_count(const LinearStructure& s) { return s.dimension() + s.acting_inputs(); }

/// The expected log posterior of switches as a function of b = log T (up to constants in rows) and of the weights W.
/// The vector of unknowns holds b row by row, then W column by column.
class SwitchObjective {
 public:
  SwitchObjective(const TrainingTransitions& transitions, const ModePosterior& posterior, const SwitchingPrior& prior,
                  const SwitchingRegression& model)
      : pairs_(posterior.pairs),
        prior_(prior),
        K_(model.modes()),
        d_(regressor_count(transitions.structure)),
        memory_information_(1.0 / (prior.memory_sd * prior.memory_sd)),
        z_((transitions.data.regressors.leftCols(d_).rowwise() - model.logit.reference.transpose()).transpose()) {
    // A transition with a missing sample switches by T, without state and input.
    for (Index k = 0; k < z_.cols(); ++k)
      if (transitions.usable(k) == 0.0) z_.col(k).setZero();
  }

  Index size() const { return K_ * K_ + K_ * d_; }
  Eigen::VectorXd pack(const SwitchingRegression& model) const {
    Eigen::VectorXd at(size());
    at << model.transition.array().max(std::numeric_limits<double>::min()).log().matrix().transpose().reshaped(),
        model.logit.weights.reshaped();
    return at;
  }
  void unpack(const Eigen::VectorXd& at, SwitchingRegression& model) const {
    model.transition = rows_of_T(at);
    model.logit.weights = at.tail(K_ * d_).reshaped(K_, d_);
  }

  double value(const Eigen::VectorXd& at) const {
    const Eigen::MatrixXd T = rows_of_T(at);
    const auto W = at.tail(K_ * d_).reshaped(K_, d_);
    double sum = -0.5 * (W * prior_.weight_sd.cwiseInverse().asDiagonal()).squaredNorm();
    sum +=
        prior_.counts * T.array().log().sum() - 0.5 * memory_information_ * memory_of(rows_of_log_T(at)).squaredNorm();
    Eigen::MatrixXd P(K_, K_);
    for (Index k = 0; k < z_.cols(); ++k) {
      set_probabilities(T, W * z_.col(k), P);
      const auto xi = pairs_.col(k).reshaped(K_, K_);
      sum += (xi.array() > 0.0).select(xi.array() * P.array().max(std::numeric_limits<double>::min()).log(), 0.0).sum();
    }
    return sum;
  }

  /// Gradient and negative Hessian.
  void derivatives(const Eigen::VectorXd& at, Eigen::VectorXd& gradient, Eigen::MatrixXd& curvature) const {
    const Eigen::MatrixXd T = rows_of_T(at);
    const auto W = at.tail(K_ * d_).reshaped(K_, d_);
    gradient.setZero(size());
    curvature.setZero(size(), size());
    add_prior(T, W, gradient, curvature);
    add_memory_prior(at, gradient, curvature);
    Eigen::MatrixXd P(K_, K_), of_row(K_, K_), of_weights(K_, K_);
    Eigen::VectorXd surprise(K_);
    for (Index k = 0; k < z_.cols(); ++k) {
      const auto z = z_.col(k);
      set_probabilities(T, W * z, P);
      const auto xi = pairs_.col(k).reshaped(K_, K_);
      of_weights.setZero();
      surprise.setZero();
      for (Index i = 0; i < K_; ++i) {
        const double weight = xi.row(i).sum();
        if (weight < negligible_share) continue;
        const auto p = P.row(i).transpose();
        const Eigen::VectorXd difference = xi.row(i).transpose() - weight * p;
        gradient.segment(i * K_, K_) += difference;
        surprise += difference;
        of_row = -weight * (p * p.transpose());
        of_row.diagonal() += weight * p;
        curvature.block(i * K_, i * K_, K_, K_) += of_row;
        of_weights += of_row;
        for (Index a = 0; a < d_; ++a) curvature.block(weights_at(a), i * K_, K_, K_) += z(a) * of_row;
      }
      for (Index a = 0; a < d_; ++a) {
        gradient.segment(weights_at(a), K_) += z(a) * surprise;
        for (Index b = 0; b <= a; ++b)
          curvature.block(weights_at(a), weights_at(b), K_, K_) += z(a) * z(b) * of_weights;
      }
    }
    curvature.triangularView<Eigen::StrictlyUpper>() = curvature.transpose();
  }

 private:
  const Eigen::MatrixXd& pairs_;
  const SwitchingPrior& prior_;
  Index K_, d_;
  double memory_information_;
  Eigen::MatrixXd z_;  ///< d x N, regressors relative to the reference

  Index weights_at(Index regressor) const { return K_ * K_ + regressor * K_; }

  Eigen::MatrixXd rows_of_log_T(const Eigen::VectorXd& at) const {
    return at.head(K_ * K_).reshaped(K_, K_).transpose();
  }

  Eigen::MatrixXd rows_of_T(const Eigen::VectorXd& at) const {
    Eigen::MatrixXd T = rows_of_log_T(at);
    for (Index i = 0; i < K_; ++i) {
      T.row(i) = (T.row(i).array() - T.row(i).maxCoeff()).exp();
      T.row(i) /= T.row(i).sum();
    }
    return T;
  }

  void set_probabilities(const Eigen::MatrixXd& T, const Eigen::VectorXd& odds, Eigen::MatrixXd& P) const {
    const Eigen::RowVectorXd factor =
        (odds.array() - odds.maxCoeff()).max(-largest_log_odds).exp().matrix().transpose();
    for (Index i = 0; i < K_; ++i) {
      P.row(i) = T.row(i).cwiseProduct(factor);
      P.row(i) /= P.row(i).sum();
    }
  }

  void add_memory_prior(const Eigen::VectorXd& at, Eigen::VectorXd& gradient, Eigen::MatrixXd& curvature) const {
    gradient.head(K_ * K_) -= memory_information_ * memory_of(rows_of_log_T(at)).transpose().reshaped();
    curvature.topLeftCorner(K_ * K_, K_ * K_) += memory_information_ * memory_projection(K_);
  }

  template <class Weights>
  void add_prior(const Eigen::MatrixXd& T, const Weights& W, Eigen::VectorXd& gradient,
                 Eigen::MatrixXd& curvature) const {
    const auto K = static_cast<double>(K_);
    for (Index i = 0; i < K_; ++i) {
      const Eigen::VectorXd p = T.row(i).transpose();
      gradient.segment(i * K_, K_) += prior_.counts * (Eigen::VectorXd::Ones(K_) - K * p);
      auto block = curvature.block(i * K_, i * K_, K_, K_);
      block -= prior_.counts * K * (p * p.transpose());
      block.diagonal() += prior_.counts * K * p;
    }
    for (Index a = 0; a < d_; ++a) {
      const double information = 1.0 / (prior_.weight_sd(a) * prior_.weight_sd(a));
      gradient.segment(weights_at(a), K_) -= information * W.col(a);
      curvature.diagonal().segment(weights_at(a), K_).array() += information;
    }
  }
};

}  // namespace

TransitionLogit no_effect(const TrainingTransitions& transitions, Index modes) {
  const Index d = regressor_count(transitions.structure);
  return {Eigen::MatrixXd::Zero(modes, d),
          transitions.data.regressors.leftCols(d).transpose() * transitions.usable / transitions.usable.sum()};
}

Eigen::VectorXd regressor_sd(const TrainingTransitions& transitions) {
  const Index d = regressor_count(transitions.structure);
  const auto z = transitions.data.regressors.leftCols(d);
  const double N = transitions.usable.sum();
  const Eigen::VectorXd mean = z.transpose() * transitions.usable / N;
  Eigen::VectorXd sd(d);
  for (Index a = 0; a < d; ++a) {
    const double square = transitions.usable.dot((z.col(a).array() - mean(a)).square().matrix()) / N;
    const double rounding = 1e-12 * std::abs(mean(a));
    sd(a) = std::sqrt(square) > rounding ? std::sqrt(square) : 1.0;
  }
  return sd;
}

SwitchingPrior with_logit_prior(SwitchingPrior prior, const TrainingTransitions& transitions,
                                const LogitPrior& logit_prior) {
  if (logit_prior.width == 0.0) return prior;
  prior.weight_sd = logit_prior.width * regressor_sd(transitions).cwiseInverse();
  prior.memory_sd = logit_prior.memory_sd;
  return prior;
}

double raise_switching(const TrainingTransitions& transitions, const ModePosterior& posterior,
                       const SwitchingPrior& prior, SwitchingRegression& model) {
  const SwitchObjective objective(transitions, posterior, prior, model);
  const Eigen::VectorXd start = objective.pack(model);
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;
  objective.derivatives(start, gradient, curvature);
  curvature.diagonal().array() += curvature_ridge * curvature.diagonal().maxCoeff();
  const Eigen::VectorXd newton = solve_semidefinite(curvature, gradient);
  const double before = objective.value(start);
  double share = 1.0;
  for (int i = 0; i < most_halvings; ++i, share *= 0.5) {
    const Eigen::VectorXd at = start + share * newton;
    const double gain = at.allFinite() ? objective.value(at) - before : -1.0;
    if (!(gain > 0.0)) continue;
    objective.unpack(at, model);
    return gain;
  }
  return 0.0;
}

}  // namespace modebank
