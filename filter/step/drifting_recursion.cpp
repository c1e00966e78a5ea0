#include "filter/step/drifting_recursion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "filter/step/equations/bounds.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;
using Vector = Eigen::Ref<const Eigen::VectorXd>;

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
      keep_(bank.running_noise.lam),
      start_variance_(bank.noise_variance()),
      floor_(bank.running_noise.floor),
      inverse_scale_(bank.drift.scale.cwiseInverse()),
      theta0_(scaled_coefficients(structure_, bank.theta(0), bank.drift.scale)),
      direction_(wandering_direction(bank)),
      h_(structure_.regressors()),
      prediction_(structure_.states),
      variance_(structure_.states),
      innovation_(structure_.states),
      sample_(structure_.states),
      Ph_(structure_.regressors(), structure_.states),
      growth_(Eigen::VectorXd::Ones(structure_.states)) {
  const Index r = structure_.regressors();
  P_.assign(static_cast<std::size_t>(structure_.states), Eigen::MatrixXd::Zero(r, r));
  P_of_.resize(static_cast<std::size_t>(structure_.states));
  start(Eigen::VectorXd::Zero(structure_.dimension()));
}

/// Gives each output its own P.
void DriftingRecursion::own_P() {
  std::iota(P_of_.begin(), P_of_.end(), Index{0});
  P_count_ = structure_.states;
}

void DriftingRecursion::start(const Vector& z) {
  theta_ = theta0_;
  v_ = start_variance_;
  z_ = z;
  P_[0].setZero();
  P_[0].diagonal().setConstant(rates_.p0);
  std::fill(P_of_.begin(), P_of_.end(), Index{0});
  P_count_ = 1;
  if (direction_.size() == 0) return;
  own_P();
  for (Eigen::MatrixXd& P : P_) P = P_[0];
}

/// Advances time between two samples: coefficients leak towards theta0 and drift.
void DriftingRecursion::pass_time() {
  if (rates_.leak != 1.0) {
    theta_ = theta0_ + rates_.leak * (theta_ - theta0_);
    for (Index g = 0; g < P_count_; ++g) P_[static_cast<std::size_t>(g)] *= rates_.leak * rates_.leak;
  }
  for (Index g = 0; g < P_count_; ++g) {
    Eigen::MatrixXd& P = P_[static_cast<std::size_t>(g)];
    if (direction_.size() == 0)
      P.diagonal().array() += rates_.q;
    else
      for (Index j = 0; j < P.cols(); ++j)
        P.col(j).tail(P.rows() - j) += rates_.q * direction_(j, g) * direction_.col(g).tail(P.rows() - j);
  }
}

void DriftingRecursion::predict(const Vector& inputs) {
  fill_regressor(structure_, z_, inputs, h_);
  h_.array() *= inverse_scale_.array();
  prediction_ = z_.head(structure_.states);
  prediction_.noalias() += theta_.transpose() * h_;
  for (double& value : prediction_) value = std::clamp(value, -largest_mean, largest_mean);
  for (Index g = 0; g < P_count_; ++g) {
    Ph_.col(g).noalias() = P_[static_cast<std::size_t>(g)].selfadjointView<Eigen::Lower>() * h_;
    growth_(g) = 1.0 + std::max(0.0, h_.dot(Ph_.col(g)));
  }
  for (Index i = 0; i < variance_.size(); ++i) variance_(i) = v_(i) * growth(i);
}

void DriftingRecursion::skip() {
  innovation_.setConstant(not_a_number);
  push(prediction_);
  pass_time();
}

/// If some outputs that share a P are measured and others are not, the outputs without a measurement get their own copy
/// of P.
void DriftingRecursion::split_partial() {
  const Index before = P_count_;
  for (Index g = 0; g < before; ++g) {
    Index measured = 0, missing = 0;
    for (Index i = 0; i < innovation_.size(); ++i)
      if (of(i) == g) ++(std::isnan(innovation_(i)) ? missing : measured);
    if (measured == 0 || missing == 0) continue;
    const Index copy = P_count_++;
    P_[static_cast<std::size_t>(copy)] = P_[static_cast<std::size_t>(g)];
    Ph_.col(copy) = Ph_.col(g);
    growth_(copy) = growth_(g);
    for (Index i = 0; i < innovation_.size(); ++i)
      if (of(i) == g && std::isnan(innovation_(i))) P_of_[static_cast<std::size_t>(i)] = copy;
  }
}

void DriftingRecursion::learn() {
  for (Index g = 0; g < P_count_; ++g) {
    bool learns = false;
    for (Index i = 0; i < innovation_.size(); ++i) {
      if (of(i) != g || std::isnan(innovation_(i))) continue;
      theta_.col(i) += innovation_(i) / growth_(g) * Ph_.col(g);
      learns = true;
    }
    if (!learns) continue;
    Eigen::MatrixXd& P = P_[static_cast<std::size_t>(g)];
    for (Index j = 0; j < P.cols(); ++j)
      P.col(j).tail(P.rows() - j) -= Ph_(j, g) / growth_(g) * Ph_.col(g).tail(P.rows() - j);
    drift::make_usable(P);
  }
}

/// A missing signal leaves its running variance unchanged.
void DriftingRecursion::adapt_variance() {
  for (Index i = 0; i < v_.size(); ++i) {
    const double e = innovation_(i);
    if (std::isnan(e)) continue;
    v_(i) = std::max(keep_ * v_(i) + (1.0 - keep_) * (e * e / growth(i)), floor_(i));
  }
}

void DriftingRecursion::update(const Vector& measured) {
  bool whole = true;
  for (Index i = 0; i < innovation_.size(); ++i) {
    const bool missing = is_missing(measured(i));
    innovation_(i) = missing ? not_a_number : measured(i) - prediction_(i);
    sample_(i) = missing ? prediction_(i) : measured(i);
    whole = whole && !missing;
  }
  if (!whole) split_partial();
  learn();
  adapt_variance();
  push(sample_);
  pass_time();
}

void DriftingRecursion::push(const Eigen::VectorXd& sample) {
  double* const z = z_.data();
  const Index n = structure_.states;
  for (Index i = z_.size() - 1; i >= n; --i) z[i] = z[i - n];
  z_.head(n) = sample;
}

DriftState DriftingRecursion::save() const {
  DriftState state;
  state.theta = theta_.reshaped(theta_.size(), 1);
  state.P.reserve(P_.size());
  for (Index i = 0; i < structure_.states; ++i) state.P.push_back(P_[static_cast<std::size_t>(of(i))]);
  state.variance = v_;
  return state;
}

void DriftingRecursion::restore(const Vector& z, const DriftState& state) {
  z_ = z;
  theta_ = state.theta.reshaped(theta_.rows(), theta_.cols());
  v_ = state.variance;
  P_ = state.P;
  own_P();
  if (direction_.size() > 0) return;
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
