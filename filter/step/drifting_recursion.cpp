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

namespace {

/// A covariance that rounding made indefinite (samples of very different sizes) keeps its variances and loses its
/// correlations; so variances never grow but by q, and nothing overflows.
void make_usable(Eigen::MatrixXd& P) {
  if (P.diagonal().minCoeff() >= 0.0) return;
  const Eigen::VectorXd variances = P.diagonal().cwiseMax(0.0);
  P = variances.asDiagonal();
}

}  // namespace

DriftingRecursion::DriftingRecursion(const LinearStructure& structure, const Eigen::VectorXd& theta0,
                                     const Eigen::VectorXd& scale, const DriftRates& rates, Eigen::MatrixXd direction)
    : structure_(structure),
      theta0_(scaled_coefficients(structure, theta0, scale)),
      inverse_scale_(scale.cwiseInverse()),
      rates_(rates),
      direction_(std::move(direction)),
      h_(structure.regressors()),
      prediction_(structure.states),
      innovation_(structure.states),
      sample_(structure.states),
      Ph_(structure.regressors(), structure.states),
      growth_(Eigen::VectorXd::Ones(structure.states)) {
  const Index r = structure.regressors();
  memory_.P.assign(static_cast<std::size_t>(structure.states), Eigen::MatrixXd::Zero(r, r));
  memory_.P_of.resize(static_cast<std::size_t>(structure.states));
  start(Eigen::VectorXd::Zero(structure.dimension()));
}

void DriftingRecursion::start(const Vector& z) {
  memory_.theta = theta0_;
  memory_.P[0].setZero();
  memory_.P[0].diagonal().setConstant(rates_.p0);
  std::fill(memory_.P_of.begin(), memory_.P_of.end(), Index{0});
  memory_.P_count = 1;
  if (direction_.size() > 0) {  // each output has its own
    std::iota(memory_.P_of.begin(), memory_.P_of.end(), Index{0});
    memory_.P_count = structure_.states;
    for (Eigen::MatrixXd& P : memory_.P) P = memory_.P[0];
  }
  memory_.z = z;
  memory_.fresh = true;
}

void DriftingRecursion::drift() {
  if (rates_.leak != 1.0) {
    memory_.theta = theta0_ + rates_.leak * (memory_.theta - theta0_);
    for (Index g = 0; g < memory_.P_count; ++g) memory_.P[static_cast<std::size_t>(g)] *= rates_.leak * rates_.leak;
  }
  for (Index g = 0; g < memory_.P_count; ++g) {
    Eigen::MatrixXd& P = memory_.P[static_cast<std::size_t>(g)];
    if (direction_.size() == 0)
      P.diagonal().array() += rates_.q;
    else
      for (Index j = 0; j < P.cols(); ++j)
        P.col(j).tail(P.rows() - j) += rates_.q * direction_(j, g) * direction_.col(g).tail(P.rows() - j);
  }
}

void DriftingRecursion::predict(const Vector& inputs) {
  if (!memory_.fresh) drift();
  memory_.fresh = false;
  fill_regressor(structure_, memory_.z, inputs, h_);
  h_.array() *= inverse_scale_.array();
  prediction_ = memory_.z.head(structure_.states);
  prediction_.noalias() += memory_.theta.transpose() * h_;
  for (double& value : prediction_) value = std::clamp(value, -largest_mean, largest_mean);
  for (Index g = 0; g < memory_.P_count; ++g) {
    Ph_.col(g).noalias() = memory_.P[static_cast<std::size_t>(g)].selfadjointView<Eigen::Lower>() * h_;
    growth_(g) = 1.0 + std::max(0.0, h_.dot(Ph_.col(g)));
  }
}

void DriftingRecursion::skip() {
  innovation_.setConstant(not_a_number);
  push(prediction_);
}

/// Outputs that share a P, of which some are measured and others not: the others get a copy.
void DriftingRecursion::split_partial() {
  const Index before = memory_.P_count;
  for (Index g = 0; g < before; ++g) {
    Index measured = 0, missing = 0;
    for (Index i = 0; i < innovation_.size(); ++i)
      if (memory_.P_of[static_cast<std::size_t>(i)] == g) ++(std::isnan(innovation_(i)) ? missing : measured);
    if (measured == 0 || missing == 0) continue;
    const Index copy = memory_.P_count++;
    memory_.P[static_cast<std::size_t>(copy)] = memory_.P[static_cast<std::size_t>(g)];
    Ph_.col(copy) = Ph_.col(g);
    growth_(copy) = growth_(g);
    for (Index i = 0; i < innovation_.size(); ++i)
      if (Index& of = memory_.P_of[static_cast<std::size_t>(i)]; of == g && std::isnan(innovation_(i))) of = copy;
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
  for (Index g = 0; g < memory_.P_count; ++g) {
    bool learns = false;
    for (Index i = 0; i < innovation_.size(); ++i) {
      if (memory_.P_of[static_cast<std::size_t>(i)] != g || std::isnan(innovation_(i))) continue;
      memory_.theta.col(i) += innovation_(i) / growth_(g) * Ph_.col(g);
      learns = true;
    }
    if (!learns) continue;
    Eigen::MatrixXd& P = memory_.P[static_cast<std::size_t>(g)];
    for (Index j = 0; j < P.cols(); ++j)
      P.col(j).tail(P.rows() - j) -= Ph_(j, g) / growth_(g) * Ph_.col(g).tail(P.rows() - j);
    make_usable(P);
  }
  push(sample_);
}

void DriftingRecursion::push(const Eigen::VectorXd& sample) {
  double* const z = memory_.z.data();
  const Index n = structure_.states;
  for (Index i = memory_.z.size() - 1; i >= n; --i) z[i] = z[i - n];
  memory_.z.head(n) = sample;
}

}  // namespace modebank
