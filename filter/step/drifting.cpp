#include "filter/step/drifting.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "ident/base/linalg.hpp"
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

/// The columns of a level in a matrix like Z_.
template <class Matrix>
auto of_level(Matrix& all, Index level) {
  return all.middleCols(level * all.rows(), all.rows());
}

/// P += factor x x', lower triangle.
template <class X, class Matrix>
void add_square(double factor, const X& x, Matrix&& P) {
  for (Index j = 0; j < P.cols(); ++j) P.col(j).tail(P.rows() - j) += factor * x(j) * x.tail(P.rows() - j);
}

}  // namespace

DriftingModel::DriftingModel(const Bank& bank)
    : structure(bank.structure),
      rates(bank.drift.rates),
      running(bank.running_noise),
      rounding(bank.rounding_variance()),
      scale(bank.drift.scale),
      inverse_scale(scale.cwiseInverse()),
      theta0(scale.asDiagonal() * bank.theta(0).reshaped(structure.regressors(), structure.states)) {}

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
  P_ = mixed_P_ = Eigen::MatrixXd::Zero(r, J * n * r);
  growth_ = of_level_ = error_ = spread_ = Eigen::MatrixXd::Zero(n, J);
  prediction_ = variance_ = innovation_ = sample_ = Eigen::VectorXd::Zero(n);
  h_ = deviation_ = Eigen::VectorXd::Zero(r);
  start(Eigen::VectorXd::Zero(model_.structure.dimension()));
}

void DriftingFilter::start(const Vector& z) {
  theta_ = model_.theta0.replicate(1, levels());
  v_ = start_variance_;
  level_ = start_level_;
  z_ = z;
  P_.setZero();
  for (Index j = 0; j < levels(); ++j)
    for (Index i = 0; i < v_.size(); ++i) part(P_, j, i).diagonal().setConstant(model_.rates.p0);
}

/// Advances the levels by one step of their chain. Each starts the step from a mixture of the levels' Gaussians.
void DriftingFilter::mix() {
  predicted_level_ = level_;
  if (!model_.switches()) return;
  mixing_weights(model_.running.switching, level_, predicted_level_, mixing_);
  floor_probabilities(predicted_level_);
  mixed_theta_.setZero();
  mixed_P_.setZero();
  for (Index j = 0; j < levels(); ++j)
    for (Index i = 0; i < v_.size(); ++i) {
      auto theta = mixed_theta_.col(at(j, i));
      for (Index l = 0; l < levels(); ++l) theta += mixing_(l, j) * theta_.col(at(l, i));
      for (Index l = 0; l < levels(); ++l) {
        deviation_ = theta_.col(at(l, i)) - theta;
        part(mixed_P_, j, i) += mixing_(l, j) * P(l, i);
        add_square(mixing_(l, j) / v_(i), deviation_, part(mixed_P_, j, i));
      }
    }
  theta_.swap(mixed_theta_);
  P_.swap(mixed_P_);
}

/// Advances time between two samples: coefficients leak towards theta0 and drift.
void DriftingFilter::pass_time() {
  const double leak = model_.rates.leak;
  if (leak != 1.0) P_ *= leak * leak;
  for (Index j = 0; j < levels(); ++j) {
    auto theta = theta_.middleCols(at(j, 0), v_.size());
    if (leak != 1.0) theta = model_.theta0 + leak * (theta - model_.theta0);
    for (Index i = 0; i < v_.size(); ++i) part(P_, j, i).diagonal().array() += model_.rates.q;
  }
}

void DriftingFilter::predict(const Vector& inputs) {
  mix();
  model_.fill(z_, inputs, h_);
  for (Index j = 0; j < levels(); ++j)
    for (Index i = 0; i < v_.size(); ++i) {
      auto Ph = Ph_.col(at(j, i));
      Ph.noalias() = P(j, i).selfadjointView<Eigen::Lower>() * h_;
      growth_(i, j) = model_.level_variance(i, j, v_(i)) + std::max(0.0, h_.dot(Ph));
      spread_(i, j) = std::sqrt(v_(i) * growth_(i, j));
      const double value = z_(i) + theta_.col(at(j, i)).dot(h_);
      // A failed prediction is not a missing sample: the value stays, and its spread is NaN.
      of_level_(i, j) = std::isnan(value) ? z_(i) : std::clamp(value, -largest_mean, largest_mean);
    }
  prediction_.noalias() = of_level_ * predicted_level_;
  variance_.setZero();
  for (Index j = 0; j < levels(); ++j)
    variance_.array() +=
        predicted_level_(j) * (v_.array() * growth_.col(j).array() + (of_level_.col(j) - prediction_).array().square());
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

double DriftingFilter::update(const Vector& measured) {
  const RunningNoise& running = model_.running;
  for (Index i = 0; i < v_.size(); ++i) {
    const bool missing = is_missing(measured(i));
    innovation_(i) = missing ? not_a_number : measured(i) - prediction_(i);
    sample_(i) = missing ? prediction_(i) : measured(i);
    error_.row(i) = sample_(i) - of_level_.row(i).array();
  }
  const double log_density = weigh_levels(innovation_.size(), level_);
  for (Index i = 0; i < v_.size(); ++i) {
    if (std::isnan(innovation_(i))) continue;
    double square = 0.0;
    for (Index j = 0; j < levels(); ++j) {
      const auto Ph = Ph_.col(at(j, i));
      auto P = part(P_, j, i);
      theta_.col(at(j, i)) += error_(i, j) / growth_(i, j) * Ph;
      add_square(-1.0 / growth_(i, j), Ph, P);
      // If samples have very different sizes, rounding makes P indefinite. So variances grow only by q per step.
      if (P.diagonal().minCoeff() < 0.0) uncorrelate(P, [&](Index k) { return std::max(0.0, P(k, k)); });
      square += level_(j) * (error_(i, j) * error_(i, j) / growth_(i, j));
    }
    v_(i) = std::max(running.lam * v_(i) + (1.0 - running.lam) * square, running.floor(i));
  }
  model_.push(sample_, z_);
  pass_time();
  return innovation_.array().isNaN().all() ? not_a_number : log_density;
}

void DriftingFilter::combine(Eigen::VectorXd& state, Eigen::MatrixXd& innovation_covariance) const {
  state = z_;
  model_.push(prediction_, state);
  innovation_covariance = variance_.asDiagonal();
}

/// `update` has returned the masses of intervals, so the log density stays.
void DriftingFilter::transform(const Vector&, Eigen::VectorXd& pit, Eigen::VectorXd& width, double&) {
  for (Index i = 0; i < pit.size(); ++i) {
    pit(i) = not_a_number;
    width(i) = 0.0;
    if (std::isnan(innovation_(i))) continue;
    weigh_levels(i, weight_);
    const double half = 0.5 * quantum_(i), low = probability(i, -half, weight_),
                 high = half > 0.0 ? probability(i, half, weight_) : low;
    const bool failed = std::isnan(high - low);
    pit(i) = failed ? 1.0 : 0.5 * (low + high);  // outside all bands if the prediction failed
    width(i) = failed ? 0.0 : high - low;
  }
}

void DriftingFilter::settle() const {
  bool usable = z_.allFinite() && theta_.allFinite() && P_.allFinite() && v_.allFinite() && level_.allFinite() &&
                v_.minCoeff() > 0.0 && level_.minCoeff() >= 0.0 && level_.sum() > 0.0;
  for (Index c = 0; c < P_.cols(); ++c) usable = usable && P_(c % P_.rows(), c) >= 0.0;
  if (!usable) throw std::invalid_argument("the snapshot has drift values that are not finite or out of range");
}

Eigen::MatrixXd contracted(const LinearStructure& s, const Eigen::VectorXd& scale, Eigen::MatrixXd theta) {
  const Index n = s.states;
  const Eigen::MatrixXd physical = scale.cwiseInverse().asDiagonal() * theta;
  const Eigen::MatrixXd F = unpack(s, Eigen::VectorXd(physical.reshaped())).full_form();
  const double radius = F.allFinite() ? eigenvalues(F).cwiseAbs().maxCoeff() : 1.0;
  if (!(radius > 1.0)) return theta;
  double shrink = 1.0;
  for (Index lag = 0; lag < s.state_lags; ++lag) {
    shrink /= radius;
    const auto rows = Eigen::seqN(lag * n, n);
    Eigen::MatrixXd A = shrink * F.block(0, lag * n, n, n);
    if (lag == 0) A.diagonal().array() -= 1.0;
    theta(rows, Eigen::all) = scale(rows).asDiagonal() * A.transpose();
  }
  return theta;
}

DriftingForecast DriftingFilter::forecast() const {
  DriftingForecast ahead(model_);
  ahead.start(*this);
  return ahead;
}

DriftingForecast::DriftingForecast(DriftingModel model)
    : model_(std::move(model)),
      stable_theta0_(contracted(model_.structure, model_.scale, model_.theta0)),
      h_(model_.structure.regressors()),
      mixing_(model_.running.levels(), model_.running.levels()),
      of_theta_(model_.structure.states) {}

/// Takes mean and covariance of theta from all levels together.
void DriftingForecast::start(const DriftingFilter& origin) {
  const Index n = model_.structure.states, r = h_.size(), dimension = model_.structure.dimension();
  v_ = origin.variance();
  level_ = origin.level();
  z_ = origin.z();
  deviation_.setZero(r, n);
  P_.setZero(r, n * r);
  for (Index j = 0; j < level_.size(); ++j) deviation_ += level_(j) * origin.theta().middleCols(j * n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < level_.size(); ++j) {
      const Eigen::VectorXd away = origin.theta().col(j * n + i) - deviation_.col(i);
      P_.middleCols(i * r, r) += level_(j) * origin.P(j, i) + level_(j) / v_(i) * away * away.transpose();
    }
  deviation_ -= model_.theta0;
  towards_ = model_.theta0;
  of_origin_ = 1.0;
  of_drift_ = 0.0;
  next_Z_ = Z_.setZero(dimension, level_.size() * dimension);
  next_cross_ = cross_.setZero(r, n * dimension);
  steps_ = 0;
}

/// The levels switch. They differ only in the covariance of the lagged errors.
void DriftingForecast::mix() {
  if (!model_.switches()) return;
  mixing_weights(model_.running.switching, Eigen::VectorXd(level_), level_, mixing_);
  floor_probabilities(level_);
  next_Z_.setZero();
  for (Index j = 0; j < level_.size(); ++j)
    for (Index i = 0; i < level_.size(); ++i) of_level(next_Z_, j) += mixing_(i, j) * of_level(Z_, i);
  Z_.swap(next_Z_);
}

void DriftingForecast::step(const Eigen::Ref<const Eigen::VectorXd>& inputs) {
  const double leak = model_.rates.leak;
  if (steps_ > 0) {
    deviation_ *= leak;
    of_origin_ *= leak * leak;
    of_drift_ = leak * leak * of_drift_ + model_.rates.q;
    cross_ *= leak;
  }
  if (++steps_ == 2) {
    deviation_ = contracted(model_.structure, model_.scale, towards_ + deviation_) - stable_theta0_;
    towards_ = stable_theta0_;
  }
  theta_ = towards_ + deviation_;
  mix();
  model_.fill(z_, inputs, h_);
  prediction_ = z_.head(v_.size()) + theta_.transpose() * h_;
  for (double& value : prediction_) value = std::clamp(value, -largest_mean, largest_mean);
  propagate_theta();
  propagate_levels();
  model_.push(prediction_, z_);
  bound();
}

/// The errors of theta and their covariances with the lagged errors.
void DriftingForecast::propagate_theta() {
  const Index n = v_.size(), dimension = Z_.rows(), r = h_.size();
  of_lagged_ = (model_.inverse_scale.head(dimension).asDiagonal() * theta_.topRows(dimension)).transpose();
  of_lagged_.leftCols(n).diagonal().array() += 1.0;
  through_.resize(n, dimension);
  for (Index i = 0; i < n; ++i) {
    const auto cross = cross_.middleCols(i * dimension, dimension);
    through_.row(i).noalias() = h_.transpose() * cross;
    Eigen::VectorXd Ph = of_origin_ * (P_.middleCols(i * r, r).selfadjointView<Eigen::Lower>() * h_);
    Ph += of_drift_ * h_;
    of_theta_(i) = std::max(0.0, h_.dot(Ph));
    auto next = next_cross_.middleCols(i * dimension, dimension);
    next.leftCols(n).noalias() = cross * of_lagged_.transpose();
    next.col(i) += v_(i) * Ph;
    next.rightCols(dimension - n) = cross.leftCols(dimension - n);
  }
  cross_.swap(next_cross_);
}

/// The covariance of the lagged errors in every level.
void DriftingForecast::propagate_levels() {
  const Index n = v_.size(), dimension = Z_.rows(), lagged = dimension - n;
  for (Index j = 0; j < level_.size(); ++j) {
    const auto Z = of_level(Z_, j);
    with_lagged_.noalias() = of_lagged_ * Z;
    covariance_.noalias() = with_lagged_ * of_lagged_.transpose();
    const Eigen::MatrixXd mixed = through_ * of_lagged_.transpose();
    covariance_ += mixed + mixed.transpose();
    with_lagged_ += through_;
    for (Index i = 0; i < n; ++i) covariance_(i, i) += v_(i) * (model_.level_variance(i, j, v_(i)) + of_theta_(i));
    auto next = of_level(next_Z_, j);
    next.topLeftCorner(n, n) = covariance_;
    next.topRightCorner(n, lagged) = with_lagged_.leftCols(lagged);
    next.bottomLeftCorner(lagged, n) = with_lagged_.leftCols(lagged).transpose();
    next.bottomRightCorner(lagged, lagged) = Z.topLeftCorner(lagged, lagged);
  }
  Z_.swap(next_Z_);
}

Eigen::MatrixXd DriftingForecast::state_covariance() const {
  Eigen::MatrixXd sum = level_(0) * of_level(Z_, 0);
  for (Index j = 1; j < level_.size(); ++j) sum += level_(j) * of_level(Z_, j);
  return sum;
}

/// Limits diverging values, as in other filters.
void DriftingForecast::bound() {
  double largest = 0.0;
  for (Index c = 0; c < Z_.cols(); ++c) largest = std::max(largest, Z_(c % Z_.rows(), c));
  if (!(largest > largest_variance)) return;
  const double shrink = std::isfinite(largest) ? largest_variance / largest : 0.0;
  Z_ *= shrink;
  cross_ *= std::sqrt(shrink);
}

}  // namespace modebank
