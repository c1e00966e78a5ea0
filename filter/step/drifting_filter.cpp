#include <cmath>
#include <stdexcept>

#include "filter/step/drifting.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

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

/// DriftingModel::direction. `theta0`: coefficients of scaled regressors.
Eigen::MatrixXd wandering_direction(const LinearStructure& s, Wandering wandering, const Eigen::MatrixXd& theta0) {
  if (wandering == Wandering::all) return {};
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(s.regressors(), s.states);
  if (wandering == Wandering::constant) {
    d.bottomRows(1).setOnes();
    return d;
  }
  const auto inputs = Eigen::seqN(s.dimension(), s.acting_inputs());
  d(inputs, Eigen::all) = theta0(inputs, Eigen::all);
  d.colwise().normalize();  // an output without input coefficients has no drift
  return d;
}

}  // namespace

DriftingModel::DriftingModel(const Bank& bank)
    : structure(bank.structure),
      rates(bank.drift.rates),
      running(bank.running_noise),
      rounding(bank.rounding_variance()),
      scale(bank.drift.scale),
      inverse_scale(scale.cwiseInverse()),
      theta0(scale.asDiagonal() * bank.theta(0).reshaped(structure.regressors(), structure.states)),
      direction(wandering_direction(structure, bank.drift.wandering, theta0)) {}

DriftingFilter::DriftingFilter(const Bank& bank)
    : model_(bank),
      noise_(bank.running_noise.nu),
      quantum_(bank.is_quantised() ? bank.quantum : Eigen::VectorXd::Zero(bank.structure.states)),
      start_variance_(bank.noise_variance()),
      start_level_(model_.switches() ? stationary(model_.running.switching) : Eigen::VectorXd::Ones(1)),
      level_(start_level_),
      predicted_level_(level_),
      mixing_(level_.size(), level_.size()),
      weight_(level_.size()) {
  const Index r = model_.structure.regressors(), n = model_.structure.states, J = levels();
  theta_ = mixed_theta_ = Ph_ = Eigen::MatrixXd::Zero(r, J * n);
  P_.assign(static_cast<std::size_t>(J * n), Eigen::MatrixXd::Zero(r, r));
  mixed_P_ = P_;
  growth_ = of_level_ = error_ = spread_ = Eigen::MatrixXd::Zero(n, J);
  prediction_ = variance_ = innovation_ = sample_ = Eigen::VectorXd::Zero(n);
  h_ = deviation_ = Eigen::VectorXd::Zero(r);
  start(Eigen::VectorXd::Zero(model_.structure.dimension()));
}

void DriftingFilter::start(const Vector& z) {
  theta_ = model_.theta0.replicate(1, levels());
  for (Eigen::MatrixXd& P : P_) P.setZero().diagonal().setConstant(model_.rates.p0);
  v_ = start_variance_;
  level_ = start_level_;
  z_ = z;
}

/// The mixture of the levels' Gaussians from which a level starts a step, for one output.
void DriftingFilter::mix_output(Index level, Index output) {
  auto theta = mixed_theta_.col(at(level, output));
  Eigen::MatrixXd& mixed = mixed_P_[static_cast<std::size_t>(at(level, output))];
  theta.setZero();
  mixed.setZero();
  for (Index i = 0; i < levels(); ++i) theta += mixing_(i, level) * theta_.col(at(i, output));
  for (Index i = 0; i < levels(); ++i) {
    const double weight = mixing_(i, level);
    mixed += weight * P(i, output);
    deviation_ = theta_.col(at(i, output)) - theta;
    add_square(weight / v_(output), deviation_, mixed);
  }
}

/// Advances the levels by one step of their chain.
void DriftingFilter::mix() {
  predicted_level_ = level_;
  if (!model_.switches()) return;
  mixing_weights(model_.running.switching, level_, predicted_level_, mixing_);
  floor_probabilities(predicted_level_);
  for (Index j = 0; j < levels(); ++j)
    for (Index i = 0; i < v_.size(); ++i) mix_output(j, i);
  theta_.swap(mixed_theta_);
  P_.swap(mixed_P_);
}

/// Advances time between two samples: coefficients leak towards theta0 and drift.
void DriftingFilter::pass_time() {
  const double leak = model_.rates.leak;
  for (Index j = 0; j < levels(); ++j) {
    auto theta = theta_.middleCols(at(j, 0), v_.size());
    if (leak != 1.0) theta = model_.theta0 + leak * (theta - model_.theta0);
    for (Index i = 0; i < v_.size(); ++i) {
      Eigen::MatrixXd& P = P_[static_cast<std::size_t>(at(j, i))];
      if (leak != 1.0) P *= leak * leak;
      if (model_.direction.size() == 0)
        P.diagonal().array() += model_.rates.q;
      else
        add_square(model_.rates.q, model_.direction.col(i), P);
    }
  }
}

void DriftingFilter::predict_level(Index j) {
  for (Index i = 0; i < v_.size(); ++i) {
    auto Ph = Ph_.col(at(j, i));
    Ph.noalias() = P(j, i).selfadjointView<Eigen::Lower>() * h_;
    growth_(i, j) = model_.level_variance(i, j, v_(i)) + std::max(0.0, h_.dot(Ph));
    const double value = z_(i) + theta_.col(at(j, i)).dot(h_);
    // A failed prediction is not a missing sample: the value stays, and its spread is NaN.
    of_level_(i, j) = std::isnan(value) ? z_(i) : std::clamp(value, -largest_mean, largest_mean);
    spread_(i, j) = std::sqrt(v_(i) * growth_(i, j));
  }
}

void DriftingFilter::predict(const Vector& inputs) {
  mix();
  model_.fill(z_, inputs, h_);
  for (Index j = 0; j < levels(); ++j) predict_level(j);
  prediction_.noalias() = of_level_ * predicted_level_;
  for (Index i = 0; i < variance_.size(); ++i) {
    variance_(i) = 0.0;
    for (Index j = 0; j < levels(); ++j) {
      const double away = of_level_(i, j) - prediction_(i);
      variance_(i) += predicted_level_(j) * (v_(i) * growth_(i, j) + away * away);
    }
  }
}

void DriftingFilter::step(const Vector& inputs) {
  predict(inputs);
  innovation_.setConstant(not_a_number);
  level_ = predicted_level_;
  model_.push(prediction_, z_);
  pass_time();
}

double DriftingFilter::log_density(Index i, Index j) const {
  const double u = error_(i, j) / spread_(i, j);
  if (quantum_(i) > 0.0) return noise_.log_mass(u, quantum_(i) / spread_(i, j)) - std::log(quantum_(i));
  return noise_.log_density(u * u) - std::log(spread_(i, j));
}

double DriftingFilter::probability(Index i, double away, const Vector& weight) const {
  double sum = 0.0;
  for (Index j = 0; j < levels(); ++j) sum += weight(j) * noise_.probability((error_(i, j) + away) / spread_(i, j));
  return sum;
}

/// Bayes' rule for the levels. A missing output has no effect.
double DriftingFilter::weigh_levels(Index outputs, Eigen::VectorXd& weight) const {
  weight.setZero(levels());
  for (Index j = 0; j < levels(); ++j)
    for (Index i = 0; i < outputs; ++i)
      if (!std::isnan(innovation_(i))) weight(j) += measured_density(log_density(i, j));
  return bayes(predicted_level_, weight, weight);
}

void DriftingFilter::learn() {
  for (Index j = 0; j < levels(); ++j)
    for (Index i = 0; i < v_.size(); ++i) {
      if (std::isnan(innovation_(i))) continue;
      const auto Ph = Ph_.col(at(j, i));
      theta_.col(at(j, i)) += error_(i, j) / growth_(i, j) * Ph;
      Eigen::MatrixXd& P = P_[static_cast<std::size_t>(at(j, i))];
      add_square(-1.0 / growth_(i, j), Ph, P);
      make_usable(P);
    }
}

/// A missing signal leaves its running variance unchanged.
void DriftingFilter::adapt_variance() {
  const RunningNoise& running = model_.running;
  for (Index i = 0; i < v_.size(); ++i) {
    if (std::isnan(innovation_(i))) continue;
    double square = 0.0;
    for (Index j = 0; j < levels(); ++j) square += level_(j) * (error_(i, j) * error_(i, j) / growth_(i, j));
    v_(i) = std::max(running.lam * v_(i) + (1.0 - running.lam) * square, running.floor(i));
  }
}

double DriftingFilter::update(const Vector& measured) {
  for (Index i = 0; i < innovation_.size(); ++i) {
    const bool missing = is_missing(measured(i));
    innovation_(i) = missing ? not_a_number : measured(i) - prediction_(i);
    sample_(i) = missing ? prediction_(i) : measured(i);
    for (Index j = 0; j < levels(); ++j) error_(i, j) = sample_(i) - of_level_(i, j);
  }
  const Index missing = innovation_.array().isNaN().count();
  const double log_density = weigh_levels(innovation_.size(), level_);
  learn();
  adapt_variance();
  model_.push(sample_, z_);
  pass_time();
  return missing == innovation_.size() ? not_a_number : log_density;
}

void DriftingFilter::combine(Eigen::VectorXd& state, Eigen::MatrixXd& innovation_covariance) const {
  state = z_;
  model_.push(prediction_, state);
  innovation_covariance.setZero();
  innovation_covariance.diagonal() = variance_;
}

/// `update` has returned the masses of intervals, so the log density stays.
void DriftingFilter::transform(const Vector&, Eigen::VectorXd& pit, Eigen::VectorXd& width, double&) {
  for (Index i = 0; i < pit.size(); ++i) {
    const double half = 0.5 * quantum_(i);
    pit(i) = not_a_number;
    if (std::isnan(innovation_(i))) continue;
    weigh_levels(i, weight_);
    pit(i) = probability(i, 0.0, weight_);
    if (std::isnan(pit(i))) pit(i) = 1.0;  // outside all bands if the prediction failed
    if (half == 0.0) continue;
    const double low = probability(i, -half, weight_), high = probability(i, half, weight_);
    if (std::isnan(high - low)) continue;
    pit(i) = 0.5 * (low + high);
    width(i) = high - low;
  }
}

void DriftingFilter::merge(Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) const {
  mean = z_;
  covariance.setZero();
}

void DriftingFilter::settle() const {
  const auto variances = [](const Eigen::MatrixXd& P) { return P.allFinite() && (P.diagonal().array() >= 0.0).all(); };
  if (!z_.allFinite() || !theta_.allFinite() || !std::all_of(P_.begin(), P_.end(), variances) || !v_.allFinite() ||
      (v_.array() <= 0.0).any() || !level_.allFinite() || (level_.array() < 0.0).any() || level_.sum() <= 0.0)
    throw std::invalid_argument("the snapshot has drift values that are not finite or out of range");
}

}  // namespace modebank
