#include "filter/step/drifting_recursion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;
using Vector = Eigen::Ref<const Eigen::VectorXd>;

namespace {

/// The stationary distribution of a chain, by repeated squaring of its transition matrix.
Eigen::VectorXd stationary(Eigen::MatrixXd T) {
  constexpr int squarings = 10;
  for (int i = 0; i < squarings; ++i) T = (T * T).eval();
  const Eigen::VectorXd mean = T.colwise().mean();
  return mean / mean.sum();
}

/// Repairs a covariance that rounding made indefinite (if samples have very different sizes). The variances stay and
/// the correlations are set to zero. So variances grow only by the additions per step, and nothing overflows.
void make_usable(Eigen::MatrixXd& P) {
  if (P.diagonal().minCoeff() >= 0.0) return;
  for (Index j = 0; j < P.cols(); ++j)
    for (Index i = 0; i < P.rows(); ++i) P(i, j) = i == j ? std::max(0.0, P(i, i)) : 0.0;
}

/// P += factor x x', lower triangle.
template <class X>
void add_square(double factor, const X& x, Eigen::MatrixXd& P) {
  for (Index j = 0; j < P.cols(); ++j) P.col(j).tail(P.rows() - j) += factor * x(j) * x.tail(P.rows() - j);
}

}  // namespace

Eigen::MatrixXd scaled_coefficients(const LinearStructure& s, const Eigen::VectorXd& theta,
                                    const Eigen::VectorXd& scale) {
  return scale.asDiagonal() * theta.reshaped(s.regressors(), s.states);
}

Eigen::MatrixXd wandering_direction(const Bank& bank) {
  const LinearStructure& s = bank.structure;
  const Wandering wandering = bank.drift.wandering;
  if (wandering == Wandering::all) return {};
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(s.regressors(), s.states);
  if (wandering == Wandering::constant) {
    d.bottomRows(1).setOnes();
    return d;
  }
  const auto inputs = Eigen::seqN(s.dimension(), s.acting_inputs());
  d(inputs, Eigen::all) = scaled_coefficients(s, bank.theta(0), bank.drift.scale)(inputs, Eigen::all);
  d.colwise().normalize();  // an output without input coefficients has no drift
  return d;
}

DriftingRecursion::DriftingRecursion(const Bank& bank)
    : structure_(bank.structure),
      rates_(bank.drift.rates),
      running_(bank.running_noise),
      noise_(running_.nu),
      quantum_(bank.is_quantised() ? bank.quantum : Eigen::VectorXd::Zero(structure_.states)),
      rounding_(bank.rounding_variance()),
      start_variance_(bank.noise_variance()),
      start_level_(running_.level.size() == 0 ? Eigen::VectorXd::Ones(1) : stationary(running_.switching)),
      inverse_scale_(bank.drift.scale.cwiseInverse()),
      theta0_(scaled_coefficients(structure_, bank.theta(0), bank.drift.scale)),
      direction_(wandering_direction(bank)),
      P_of_(static_cast<std::size_t>(structure_.states)),
      level_(start_level_),
      predicted_level_(level_),
      mixing_{Eigen::MatrixXd(level_.size(), level_.size())},
      h_(structure_.regressors()),
      prediction_(structure_.states),
      variance_(structure_.states),
      innovation_(structure_.states),
      sample_(structure_.states),
      deviation_(structure_.regressors()) {
  const Index r = structure_.regressors(), n = structure_.states, J = levels();
  theta_ = mixed_theta_ = Ph_ = Eigen::MatrixXd::Zero(r, J * n);
  P_.assign(static_cast<std::size_t>(J * n), Eigen::MatrixXd::Zero(r, r));
  mixed_P_ = P_;
  growth_ = Eigen::VectorXd::Ones(J * n);
  of_level_ = error_ = spread_ = Eigen::MatrixXd::Zero(n, J);
  start(Eigen::VectorXd::Zero(structure_.dimension()));
}

/// Gives each output its own P.
void DriftingRecursion::own_P() {
  std::iota(P_of_.begin(), P_of_.end(), Index{0});
  P_count_ = structure_.states;
}

void DriftingRecursion::start(const Vector& z) {
  for (Index j = 0; j < levels(); ++j) theta_.middleCols(at(j, 0), structure_.states) = theta0_;
  v_ = start_variance_;
  level_ = start_level_;
  z_ = z;
  for (Eigen::MatrixXd& P : P_) {
    P.setZero();
    P.diagonal().setConstant(rates_.p0);
  }
  std::fill(P_of_.begin(), P_of_.end(), Index{0});
  P_count_ = 1;
  if (direction_.size() > 0 || switches()) own_P();
}

/// The mixture of the levels' Gaussians from which a level starts a step, for one output.
void DriftingRecursion::mix_output(Index level, Index output) {
  auto theta = mixed_theta_.col(at(level, output));
  Eigen::MatrixXd& P = mixed_P_[static_cast<std::size_t>(at(level, output))];
  theta.setZero();
  P.setZero();
  for (Index i = 0; i < levels(); ++i) theta += mixing_.matrix(i, level) * theta_.col(at(i, output));
  for (Index i = 0; i < levels(); ++i) {
    const double weight = mixing_.matrix(i, level);
    P += weight * P_[static_cast<std::size_t>(at(i, output))];
    deviation_ = theta_.col(at(i, output)) - theta;
    add_square(weight / v_(output), deviation_, P);
  }
}

/// Advances the levels by one step of their chain.
void DriftingRecursion::mix() {
  predicted_level_ = level_;
  if (!switches()) return;
  mixing_weights(running_.switching, level_, predicted_level_, mixing_);
  floor_probabilities(predicted_level_);
  for (Index j = 0; j < levels(); ++j)
    for (Index i = 0; i < structure_.states; ++i) mix_output(j, i);
  theta_.swap(mixed_theta_);
  P_.swap(mixed_P_);
}

/// Advances time between two samples: coefficients leak towards theta0 and drift.
void DriftingRecursion::pass_time() {
  const double leak = rates_.leak;
  for (Index j = 0; j < levels(); ++j) {
    auto theta = theta_.middleCols(at(j, 0), structure_.states);
    if (leak != 1.0) theta = theta0_ + leak * (theta - theta0_);
    for (Index g = 0; g < P_count_; ++g) {
      if (leak != 1.0) P(j, g) *= leak * leak;
      if (direction_.size() == 0)
        P(j, g).diagonal().array() += rates_.q;
      else
        add_square(rates_.q, direction_.col(g), P(j, g));
    }
  }
}

void DriftingRecursion::predict_level(Index j) {
  for (Index g = 0; g < P_count_; ++g) {
    auto Ph = Ph_.col(at(j, g));
    Ph.noalias() = P(j, g).selfadjointView<Eigen::Lower>() * h_;
    growth_(at(j, g)) = level_variance(running_, g, j, rounding_(g) / v_(g)) + std::max(0.0, h_.dot(Ph));
  }
  for (Index i = 0; i < structure_.states; ++i) {
    const double value = z_(i) + theta_.col(at(j, i)).dot(h_);
    // A failed prediction is not a missing sample: the value stays, and its spread is NaN.
    of_level_(i, j) = std::isnan(value) ? z_(i) : std::clamp(value, -largest_mean, largest_mean);
    spread_(i, j) = std::sqrt(v_(i) * growth_(at(j, of(i))));
  }
}

void DriftingRecursion::predict(const Vector& inputs) {
  mix();
  fill_regressor(structure_, z_, inputs, h_);
  h_.array() *= inverse_scale_.array();
  for (Index j = 0; j < levels(); ++j) predict_level(j);
  prediction_.noalias() = of_level_ * predicted_level_;
  for (Index i = 0; i < variance_.size(); ++i) {
    variance_(i) = 0.0;
    for (Index j = 0; j < levels(); ++j) {
      const double away = of_level_(i, j) - prediction_(i);
      variance_(i) += predicted_level_(j) * (v_(i) * growth_(at(j, of(i))) + away * away);
    }
  }
}

void DriftingRecursion::skip() {
  innovation_.setConstant(not_a_number);
  level_ = predicted_level_;
  push(prediction_);
  pass_time();
}

/// If some outputs that share a P are measured and others are not, the outputs without a measurement get their own copy
/// of P. Only with one level: several levels share no P.
void DriftingRecursion::split_partial() {
  const Index before = P_count_;
  for (Index g = 0; g < before; ++g) {
    Index measured = 0, missing = 0;
    for (Index i = 0; i < innovation_.size(); ++i)
      if (of(i) == g) ++(std::isnan(innovation_(i)) ? missing : measured);
    if (measured == 0 || missing == 0) continue;
    const Index copy = P_count_++;
    P(0, copy) = P(0, g);
    Ph_.col(copy) = Ph_.col(g);
    growth_(copy) = growth_(g);
    for (Index i = 0; i < innovation_.size(); ++i)
      if (of(i) == g && std::isnan(innovation_(i))) P_of_[static_cast<std::size_t>(i)] = copy;
  }
}

double DriftingRecursion::log_density(Index i, Index j) const {
  const double u = error_(i, j) / spread_(i, j);
  if (quantum_(i) > 0.0) return noise_.log_mass(u, quantum_(i) / spread_(i, j)) - std::log(quantum_(i));
  return noise_.log_density(u * u) - std::log(spread_(i, j));
}

double DriftingRecursion::probability(Index i, double away, const Vector& weight) const {
  double sum = 0.0;
  for (Index j = 0; j < levels(); ++j) sum += weight(j) * noise_.probability((error_(i, j) + away) / spread_(i, j));
  return sum;
}

/// Bayes' rule for the levels. A missing output has no effect.
double DriftingRecursion::weigh_levels(Index outputs, Eigen::VectorXd& weight) const {
  weight.setZero(levels());
  for (Index j = 0; j < levels(); ++j)
    for (Index i = 0; i < outputs; ++i)
      if (!std::isnan(innovation_(i))) weight(j) += measured_density(log_density(i, j));
  return bayes(predicted_level_, weight, weight);
}

void DriftingRecursion::learn() {
  for (Index j = 0; j < levels(); ++j)
    for (Index g = 0; g < P_count_; ++g) {
      bool learns = false;
      const auto Ph = Ph_.col(at(j, g));
      const double growth = growth_(at(j, g));
      for (Index i = 0; i < innovation_.size(); ++i) {
        if (of(i) != g || std::isnan(innovation_(i))) continue;
        theta_.col(at(j, i)) += error_(i, j) / growth * Ph;
        learns = true;
      }
      if (!learns) continue;
      add_square(-1.0 / growth, Ph, P(j, g));
      make_usable(P(j, g));
    }
}

/// A missing signal leaves its running variance unchanged.
void DriftingRecursion::adapt_variance() {
  for (Index i = 0; i < v_.size(); ++i) {
    if (std::isnan(innovation_(i))) continue;
    double square = 0.0;
    for (Index j = 0; j < levels(); ++j) square += level_(j) * (error_(i, j) * error_(i, j) / growth_(at(j, of(i))));
    v_(i) = std::max(running_.lam * v_(i) + (1.0 - running_.lam) * square, running_.floor(i));
  }
}

double DriftingRecursion::update(const Vector& measured) {
  bool whole = true;
  for (Index i = 0; i < innovation_.size(); ++i) {
    const bool missing = is_missing(measured(i));
    innovation_(i) = missing ? not_a_number : measured(i) - prediction_(i);
    sample_(i) = missing ? prediction_(i) : measured(i);
    for (Index j = 0; j < levels(); ++j) error_(i, j) = sample_(i) - of_level_(i, j);
    whole = whole && !missing;
  }
  if (!whole && !switches()) split_partial();
  const double log_density = weigh_levels(innovation_.size(), level_);
  learn();
  adapt_variance();
  push(sample_);
  pass_time();
  return innovation_.array().isNaN().all() ? not_a_number : log_density;
}

void DriftingRecursion::push(const Eigen::VectorXd& sample) {
  double* const z = z_.data();
  const Index n = structure_.states;
  for (Index i = z_.size() - 1; i >= n; --i) z[i] = z[i - n];
  z_.head(n) = sample;
}

DriftState DriftingRecursion::save() const {
  DriftState state{theta_.reshaped(theta_.rows() * structure_.states, levels()), {}, v_, level_};
  state.P.reserve(P_.size());
  for (Index j = 0; j < levels(); ++j)
    for (Index i = 0; i < structure_.states; ++i) state.P.push_back(P_[static_cast<std::size_t>(at(j, of(i)))]);
  return state;
}

void DriftingRecursion::restore(const Vector& z, const DriftState& state) {
  z_ = z;
  theta_ = state.theta.reshaped(theta_.rows(), theta_.cols());
  v_ = state.variance;
  level_ = state.level;
  P_ = state.P;
  own_P();
  if (direction_.size() > 0 || switches()) return;
  P_count_ = 0;  // outputs with equal P share one P, as in the saved filter
  for (std::size_t i = 0; i < P_of_.size(); ++i) {
    const auto equal = [&](Index g) { return P_[static_cast<std::size_t>(g)] == state.P[i]; };
    Index g = 0;
    while (g < P_count_ && !equal(g)) ++g;
    P_of_[i] = g;
    if (g < P_count_) continue;
    P_[static_cast<std::size_t>(g)] = state.P[i];
    ++P_count_;
  }
}

}  // namespace modebank
