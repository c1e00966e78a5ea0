#include <cmath>
#include <utility>

#include "filter/step/drifting.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {

using Eigen::Index;

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

DriftingForecast::DriftingForecast(DriftingModel model)
    : model_(std::move(model)),
      stable_theta0_(contracted(model_.structure, model_.scale, model_.theta0)),
      P_(static_cast<std::size_t>(model_.structure.states)),
      h_(model_.structure.regressors()),
      mixing_(model_.running.levels(), model_.running.levels()),
      Z_(static_cast<std::size_t>(model_.running.levels())),
      cross_(P_.size()),
      next_cross_(cross_),
      of_theta_(model_.structure.states) {}

DriftingForecast DriftingFilter::forecast() const {
  DriftingForecast ahead(model_);
  ahead.start(*this);
  return ahead;
}

/// Mean and covariance of theta at the origin, of all levels together.
void DriftingForecast::merge_levels(const DriftingFilter& origin) {
  const Index n = v_.size();
  deviation_.setZero(h_.size(), n);
  for (Index j = 0; j < level_.size(); ++j) deviation_ += level_(j) * origin.theta().middleCols(j * n, n);
  for (Index i = 0; i < n; ++i) {
    Eigen::MatrixXd& P = P_[static_cast<std::size_t>(i)];
    P.setZero(h_.size(), h_.size());
    for (Index j = 0; j < level_.size(); ++j) {
      const Eigen::VectorXd away = origin.theta().col(j * n + i) - deviation_.col(i);
      P += level_(j) * origin.P(j, i);
      P += level_(j) / v_(i) * away * away.transpose();
    }
  }
  deviation_ -= model_.theta0;
}

void DriftingForecast::start(const DriftingFilter& origin) {
  const LinearStructure& s = model_.structure;
  v_ = origin.variance();
  level_ = origin.level();
  z_ = origin.z();
  merge_levels(origin);
  towards_ = model_.theta0;
  of_origin_ = 1.0;
  of_drift_ = 0.0;
  for (Eigen::MatrixXd& Z : Z_) Z.setZero(s.dimension(), s.dimension());
  for (Eigen::MatrixXd& C : cross_) C.setZero(s.regressors(), s.dimension());
  next_Z_ = Z_;
  next_cross_ = cross_;
  steps_ = 0;
}

/// The levels switch. They differ only in the covariance of the lagged errors.
void DriftingForecast::mix() {
  if (!model_.switches()) return;
  mixing_weights(model_.running.switching, Eigen::VectorXd(level_), level_, mixing_);
  floor_probabilities(level_);
  for (Index j = 0; j < level_.size(); ++j) {
    Eigen::MatrixXd& mixed = next_Z_[static_cast<std::size_t>(j)];
    mixed.setZero();
    for (Index i = 0; i < level_.size(); ++i) mixed += mixing_(i, j) * Z_[static_cast<std::size_t>(i)];
  }
  std::swap(Z_, next_Z_);
}

void DriftingForecast::pass_time() {
  const double leak = model_.rates.leak;
  deviation_ *= leak;
  of_origin_ *= leak * leak;
  of_drift_ = leak * leak * of_drift_ + model_.rates.q;
  for (Eigen::MatrixXd& C : cross_) C *= leak;
}

void DriftingForecast::step(const Eigen::Ref<const Eigen::VectorXd>& inputs) {
  if (steps_ > 0) pass_time();
  if (++steps_ == 2) {
    deviation_ = contracted(model_.structure, model_.scale, towards_ + deviation_) - stable_theta0_;
    towards_ = stable_theta0_;
  }
  theta_ = towards_ + deviation_;
  mix();
  predict_mean(inputs);
  propagate_errors();
  model_.push(prediction_, z_);
  bound();
}

void DriftingForecast::predict_mean(const Eigen::Ref<const Eigen::VectorXd>& inputs) {
  model_.fill(z_, inputs, h_);
  prediction_ = z_.head(model_.structure.states) + theta_.transpose() * h_;
  for (double& value : prediction_) value = std::clamp(value, -largest_mean, largest_mean);
}

void DriftingForecast::propagate_errors() {
  const Index n = model_.structure.states, dimension = model_.structure.dimension();
  of_lagged_ = (model_.inverse_scale.head(dimension).asDiagonal() * theta_.topRows(dimension)).transpose();
  of_lagged_.leftCols(n).diagonal().array() += 1.0;
  through_.resize(n, dimension);
  for (Index i = 0; i < n; ++i) through_.row(i).noalias() = h_.transpose() * cross_[static_cast<std::size_t>(i)];
  for (Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    Eigen::VectorXd Ph = P_[at].selfadjointView<Eigen::Lower>() * h_;
    if (model_.direction.size() == 0)
      Ph = of_origin_ * Ph + of_drift_ * h_;
    else
      Ph = of_origin_ * Ph + of_drift_ * model_.direction.col(i).dot(h_) * model_.direction.col(i);
    of_theta_(i) = std::max(0.0, h_.dot(Ph));
    Eigen::MatrixXd& next = next_cross_[at];
    next.leftCols(n).noalias() = cross_[at] * of_lagged_.transpose();
    next.col(i) += v_(i) * Ph;
    next.rightCols(dimension - n) = cross_[at].leftCols(dimension - n);
  }
  for (std::size_t j = 0; j < Z_.size(); ++j) propagate_level(j);
  std::swap(Z_, next_Z_);
  std::swap(cross_, next_cross_);
}

void DriftingForecast::propagate_level(std::size_t level) {
  const Index n = model_.structure.states, lagged = model_.structure.dimension() - n;
  const Eigen::MatrixXd& Z = Z_[level];
  with_lagged_.noalias() = of_lagged_ * Z;
  covariance_.noalias() = with_lagged_ * of_lagged_.transpose();
  const Eigen::MatrixXd mixed = through_ * of_lagged_.transpose();
  covariance_ += mixed + mixed.transpose();
  with_lagged_ += through_;
  for (Index i = 0; i < n; ++i) {
    const double noise = model_.level_variance(i, static_cast<Index>(level), v_(i));
    covariance_(i, i) += v_(i) * (noise + of_theta_(i));
  }
  Eigen::MatrixXd& next = next_Z_[level];
  next.topLeftCorner(n, n) = covariance_;
  next.topRightCorner(n, lagged) = with_lagged_.leftCols(lagged);
  next.bottomLeftCorner(lagged, n) = with_lagged_.leftCols(lagged).transpose();
  next.bottomRightCorner(lagged, lagged) = Z.topLeftCorner(lagged, lagged);
}

Eigen::MatrixXd DriftingForecast::state_covariance() const {
  Eigen::MatrixXd sum = level_(0) * Z_[0];
  for (std::size_t j = 1; j < Z_.size(); ++j) sum += level_(static_cast<Index>(j)) * Z_[j];
  return sum;
}

/// Limits diverging values, as in other filters.
void DriftingForecast::bound() {
  double largest = 0.0;
  for (const Eigen::MatrixXd& Z : Z_) largest = std::max(largest, Z.diagonal().maxCoeff());
  if (!(largest > largest_variance)) return;
  const double shrink = std::isfinite(largest) ? largest_variance / largest : 0.0;
  for (Eigen::MatrixXd& Z : Z_) Z *= shrink;
  for (Eigen::MatrixXd& C : cross_) C *= std::sqrt(shrink);
}

}  // namespace modebank
