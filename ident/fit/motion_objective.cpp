#include "ident/fit/motion_objective.hpp"

#include <algorithm>
#include <cmath>

namespace modebank {

namespace {

constexpr double smallest_square = 1e-4;  // of a whitened residual; below it sqrt(rho / s) is a series

double square(const double* r, Index n) {
  double sum = 0.0;
  for (Index i = 0; i < n; ++i) sum += r[i] * r[i];
  return sum;
}

/// pull = J' r of one sample.
void project(const double* r, const double* J, Index n, Index u, double* pull) {
  for (Index j = 0; j < u; ++j) pull[j] = J[j] * r[0];
  for (Index i = 1; i < n; ++i)
    for (Index j = 0; j < u; ++j) pull[j] += J[i * u + j] * r[i];
}

/// Adds factor a a' to a lower triangle.
void add_outer(double factor, const double* a, Index u, double* H) {
  for (Index l = 0; l < u; ++l) {
    const double scaled = factor * a[l];
    for (Index j = l; j < u; ++j) H[l * u + j] += scaled * a[j];
  }
}

}  // namespace

ModelObjective::ModelObjective(const ModelResiduals& residuals, const Eigen::VectorXd& sigma,
                               const ParameterPrior* prior)
    : residuals_(residuals),
      inverse_sigma_(sigma.cwiseInverse()),
      prior_(prior),
      pull_(static_cast<std::size_t>(residuals.unknowns())) {}

void ModelObjective::linearise(const double* at, bool with_derivatives) const {
  residuals_.evaluate(at, r_, with_derivatives ? &J_ : nullptr);
  const Index n = residuals_.states(), columns = with_derivatives ? J_.cols() : 0;
  double *r = r_.data(), *J = J_.data();
  for (Index k = 0; k < samples(); ++k)
    for (Index i = 0; i < n; ++i) {
      *r++ *= inverse_sigma_(i);
      for (Index j = 0; j < columns; ++j) *J++ *= inverse_sigma_(i);
    }
}

double ModelObjective::cost(const Eigen::VectorXd& at, const RobustLoss& loss) const {
  linearise(at.data(), false);
  const Index n = residuals_.states();
  double sum = 0.0;
  for (Index k = 0; k < samples(); ++k) sum += residuals_.weight(k) * loss(square(r_.data() + k * n, n)).rho;
  if (prior_) sum += ((at.head(prior_rows()) - prior_->mean).array() / prior_->sd.array()).square().sum();
  return 0.5 * sum;
}

void ModelObjective::add_sample(const double* r, const double* J, double weight, double curvature, double s,
                                Expansion& e) const {
  const Index n = residuals_.states(), u = unknowns();
  double* const H = e.hessian.data();
  project(r, J, n, u, pull_.data());
  for (Index j = 0; j < u; ++j) e.gradient(j) -= weight * pull_[static_cast<std::size_t>(j)];
  if (n == 1) return add_outer(weight + curvature * s, J, u, H);
  for (Index i = 0; i < n; ++i) add_outer(weight, J + i * u, u, H);
  if (curvature != 0.0) add_outer(curvature, pull_.data(), u, H);
}

void ModelObjective::add_prior(const Eigen::VectorXd& at, Expansion& e) const {
  for (Index j = 0; j < prior_rows(); ++j) {
    const double precision = 1.0 / (prior_->sd(j) * prior_->sd(j)), away = at(j) - prior_->mean(j);
    e.gradient(j) += precision * away;
    e.hessian(j, j) += precision;
    e.cost += precision * away * away;
    e.psi_square += precision * away * away;
  }
}

void ModelObjective::expand(const Eigen::VectorXd& at, const RobustLoss& loss, LossCurvature curvature,
                            Expansion& e) const {
  linearise(at.data(), true);
  const Index n = residuals_.states(), u = unknowns();
  e.gradient.setZero(u);
  e.hessian.setZero(u, u);
  e.cost = e.psi_square = 0.0;
  for (Index k = 0; k < samples(); ++k) {
    const double* const r = r_.data() + k * n;
    const double s = square(r, n), w = residuals_.weight(k);
    const LossValue value = loss(s);
    e.cost += w * value.rho;
    e.psi_square += w * value.weight * value.weight * s;
    add_sample(r, J_.data() + k * n * u, w * value.weight,
               curvature == LossCurvature::taken ? 2.0 * w * value.curvature : 0.0, s, e);
  }
  add_prior(at, e);
  e.cost *= 0.5;
  e.hessian.triangularView<Eigen::StrictlyUpper>() = e.hessian.transpose();
}

void ModelObjective::least_squares_rows(const double* at, const RobustLoss& loss, double* f, double* jacobian) const {
  linearise(at, jacobian != nullptr);
  const Index n = residuals_.states(), u = unknowns();
  for (Index k = 0; k < samples(); ++k) {
    const double* const r = r_.data() + k * n;
    const double s = square(r, n), root_weight = std::sqrt(residuals_.weight(k));
    const LossValue value = loss(s);
    const bool small = s < smallest_square;
    const double h = root_weight * (small ? 1.0 + 0.25 * value.curvature * s : std::sqrt(value.rho / s));
    for (Index i = 0; i < n; ++i) f[k * n + i] = h * r[i];
    if (!jacobian) continue;
    const double slope = root_weight * (small ? 0.25 * value.curvature
                                              : 0.5 * (value.weight * s - value.rho) / (s * std::sqrt(s * value.rho)));
    project(r, J_.data() + k * n * u, n, u, pull_.data());
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < u; ++j)
        jacobian[(k * n + i) * u + j] = -h * J_(k * n + i, j) - 2.0 * slope * pull_[static_cast<std::size_t>(j)] * r[i];
  }
  for (Index j = 0; j < prior_rows(); ++j) {
    f[residuals_.rows() + j] = (at[j] - prior_->mean(j)) / prior_->sd(j);
    if (!jacobian) continue;
    double* const row = jacobian + (residuals_.rows() + j) * u;
    std::fill(row, row + u, 0.0);
    row[j] = 1.0 / prior_->sd(j);
  }
}

}  // namespace modebank
