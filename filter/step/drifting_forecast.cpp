#include "filter/step/drifting_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/step/drifting_recursion.hpp"
#include "filter/step/equations/bounds.hpp"
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

DriftingForecast::DriftingForecast(const Bank& bank)
    : structure_(bank.structure),
      rates_(bank.drift.rates),
      scale_(bank.drift.scale),
      inverse_scale_(scale_.cwiseInverse()),
      theta0_(scaled_coefficients(structure_, bank.theta(0), scale_)),
      stable_theta0_(contracted(structure_, scale_, theta0_)),
      h_(structure_.regressors()),
      direction_(wandering_direction(bank)),
      cross_(static_cast<std::size_t>(structure_.states)),
      next_cross_(cross_) {}

void DriftingForecast::start(const Eigen::Ref<const Eigen::VectorXd>& z, DriftState origin) {
  const LinearStructure& s = structure_;
  origin_ = std::move(origin);
  z_ = z;
  towards_ = theta0_;
  deviation_ = origin_.theta.reshaped(s.regressors(), s.states) - theta0_;
  of_origin_ = 1.0;
  of_drift_ = 0.0;
  Z_.setZero(s.dimension(), s.dimension());
  for (Eigen::MatrixXd& C : cross_) C.setZero(s.regressors(), s.dimension());
  next_Z_ = Z_;
  next_cross_ = cross_;
  steps_ = 0;
}

void DriftingForecast::pass_time() {
  const double leak = rates_.leak;
  deviation_ *= leak;
  of_origin_ *= leak * leak;
  of_drift_ = leak * leak * of_drift_ + rates_.q;
  for (Eigen::MatrixXd& C : cross_) C *= leak;
}

void DriftingForecast::step(const Eigen::Ref<const Eigen::VectorXd>& inputs) {
  if (steps_ > 0) pass_time();
  if (++steps_ == 2) {
    deviation_ = contracted(structure_, scale_, towards_ + deviation_) - stable_theta0_;
    towards_ = stable_theta0_;
  }
  theta_ = towards_ + deviation_;
  predict_mean(inputs);
  propagate_errors();
  push();
  bound();
}

void DriftingForecast::predict_mean(const Eigen::Ref<const Eigen::VectorXd>& inputs) {
  fill_regressor(structure_, z_, inputs, h_);
  h_.array() *= inverse_scale_.array();
  prediction_ = z_.head(structure_.states) + theta_.transpose() * h_;
  for (double& value : prediction_) value = std::clamp(value, -largest_mean, largest_mean);
}

void DriftingForecast::propagate_errors() {
  const Index n = structure_.states, dimension = structure_.dimension();
  of_lagged_ = (inverse_scale_.head(dimension).asDiagonal() * theta_.topRows(dimension)).transpose();
  of_lagged_.leftCols(n).diagonal().array() += 1.0;
  with_lagged_.noalias() = of_lagged_ * Z_;
  through_.resize(n, dimension);
  for (Index i = 0; i < n; ++i) through_.row(i).noalias() = h_.transpose() * cross_[static_cast<std::size_t>(i)];
  covariance_.noalias() = with_lagged_ * of_lagged_.transpose();
  const Eigen::MatrixXd mixed = through_ * of_lagged_.transpose();
  covariance_ += mixed + mixed.transpose();
  with_lagged_ += through_;
  for (Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    Eigen::VectorXd Ph = origin_.P[at].selfadjointView<Eigen::Lower>() * h_;
    if (direction_.size() == 0)
      Ph = of_origin_ * Ph + of_drift_ * h_;
    else
      Ph = of_origin_ * Ph + of_drift_ * direction_.col(i).dot(h_) * direction_.col(i);
    covariance_(i, i) += origin_.variance(i) * (1.0 + std::max(0.0, h_.dot(Ph)));
    Eigen::MatrixXd& next = next_cross_[at];
    next.leftCols(n).noalias() = cross_[at] * of_lagged_.transpose();
    next.col(i) += origin_.variance(i) * Ph;
    next.rightCols(dimension - n) = cross_[at].leftCols(dimension - n);
  }
}

void DriftingForecast::push() {
  const Index n = structure_.states, lagged = structure_.dimension() - n;
  next_Z_.topLeftCorner(n, n) = covariance_;
  next_Z_.topRightCorner(n, lagged) = with_lagged_.leftCols(lagged);
  next_Z_.bottomLeftCorner(lagged, n) = with_lagged_.leftCols(lagged).transpose();
  next_Z_.bottomRightCorner(lagged, lagged) = Z_.topLeftCorner(lagged, lagged);
  std::swap(Z_, next_Z_);
  std::swap(cross_, next_cross_);
  for (Index i = z_.size() - 1; i >= n; --i) z_(i) = z_(i - n);
  z_.head(n) = prediction_;
}

/// Limits diverging values, as in other filters.
void DriftingForecast::bound() {
  const double largest = Z_.diagonal().maxCoeff();
  if (!(largest > largest_variance)) return;
  const double shrink = std::isfinite(largest) ? largest_variance / largest : 0.0;
  Z_ *= shrink;
  covariance_ *= shrink;
  for (Eigen::MatrixXd& C : cross_) C *= std::sqrt(shrink);
}

}  // namespace modebank
