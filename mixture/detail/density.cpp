#include "mixture/detail/density.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "ident/base/linalg.hpp"
#include "ident/base/log_two_pi.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// A component is central if the distance from the origin to its mean is at most this number of standard deviations.
/// Squares about the origin then lose at most three digits.
constexpr double central_distance = 32.0;

/// Packs W in the layout of the kernels. `diagonal`: whether W is diagonal.
void pack(const Eigen::MatrixXd& W, const Eigen::VectorXd& mean, em::Packing packing, bool diagonal,
          std::vector<double>& out) {
  constexpr Index tile = 4;
  const double unit = std::sqrt(0.5 * std::numbers::log2e);
  const Index F = W.rows();
  switch (packing) {
    case em::Packing::diagonal:
      for (Index i = 0; i < F; ++i) out.push_back(W(i, i));
      break;
    case em::Packing::affine:
      for (Index i = 0; i < F; ++i)
        for (Index j = diagonal ? i : 0; j <= i; ++j) out.push_back(unit * W(i, j));
      for (Index i = 0; i < F; ++i) out.push_back(-unit * W.row(i).dot(mean));
      break;
    case em::Packing::whole:
      out.insert(out.end(), W.data(), W.data() + W.size());
      break;
    case em::Packing::tiles:
      for (Index row = 0; row < F; row += tile)
        for (Index j = 0; j < std::min(row + tile, F); ++j)
          for (Index i = row; i < row + tile; ++i) out.push_back(i < F && j <= i ? W(i, j) : 0.0);
  }
}

/// Converts sums about the origin into sums about `mean`.
void to_sums_about(const Eigen::VectorXd& mean, bool diagonal, Eigen::Ref<Eigen::VectorXd> sums) {
  const Index F = mean.size();
  const Eigen::VectorXd about_origin = sums.segment(1, F);
  sums.segment(1, F) -= sums(0) * mean;
  for (Index i = 0, row = 1 + F; i < F; ++i)
    for (Index j = diagonal ? i : 0; j <= i; ++j, ++row) sums(row) -= mean(i) * sums(1 + j) + mean(j) * about_origin(i);
}

}  // namespace

FactoredMixture::FactoredMixture(const GaussianMixture& mixture, bool errors)
    : means_(mixture.means),
      diagonal_(mixture.type == CovarianceType::diagonal),
      noise_(mixture.noise.present()),
      kernels_(errors ? em::error_kernels(static_cast<int>(mixture.features()), diagonal_)
                      : em::plain_kernels(static_cast<int>(mixture.features()), diagonal_)),
      central_(new bool[static_cast<std::size_t>(mixture.components())]),
      log_constants_(mixture.components()) {
  const Index F = mixture.features();
  const double log_normal = -0.5 * static_cast<double>(F) * log_two_pi;
  Cholesky cholesky;
  for (Index k = 0; k < mixture.components(); ++k) {
    const Eigen::MatrixXd& covariance = mixture.covariances[k];
    if (diagonal_)
      cholesky.factorise(covariance.diagonal().asDiagonal());
    else
      cholesky.factorise(covariance);
    const Eigen::MatrixXd L = cholesky.L(), W = cholesky.whiten(Eigen::MatrixXd(Eigen::MatrixXd::Identity(F, F)));
    if (!cholesky.definite() || !L.allFinite() || !W.allFinite())
      throw NotPositiveDefinite(fmt::format(
          "covariance of mixture component {} of {} features is not positive definite (smallest variance {})", k, F,
          covariance.diagonal().minCoeff()));
    pack(W, mixture.means.col(k), kernels_.packing, diagonal_, whitening_);
    central_[static_cast<std::size_t>(k)] = (W * mixture.means.col(k)).norm() < central_distance;
    if (errors) cholesky_.push_back(L);
    const double log_weight = mixture.weights(k) > 0.0 ? std::log(mixture.weights(k)) : log_zero;
    log_constants_(k) = log_weight + W.diagonal().array().log().sum() + log_normal;
  }
  stride_ = static_cast<Index>(whitening_.size()) / mixture.components();
  if (noise_)
    log_noise_ = mixture.noise.weight > 0.0 ? std::log(mixture.noise.weight) + mixture.noise.log_density() : log_zero;
}

em::Components FactoredMixture::components() const {
  em::Components result;
  result.features = static_cast<int>(means_.rows());
  result.count = static_cast<int>(means_.cols());
  result.diagonal = diagonal_;
  result.means = means_.data();
  result.whitening = whitening_.data();
  result.stride = stride_;
  result.log_constants = log_constants_.data();
  result.central = central_.get();
  return result;
}

void FactoredMixture::to_plain_sums(Index component, Eigen::Ref<Eigen::VectorXd> sums) const {
  if (kernels_.packing == em::Packing::affine) {
    if (central_[static_cast<std::size_t>(component)]) to_sums_about(means_.col(component), diagonal_, sums);
    return;
  }
  if (cholesky_.empty()) return;
  const Eigen::MatrixXd& L = cholesky_[static_cast<std::size_t>(component)];
  const Index F = L.rows();
  if (diagonal_) {
    sums.segment(1, F).array() *= L.diagonal().array();
    sums.tail(F).array() *= L.diagonal().array().square();
    return;
  }
  sums.segment(1, F) = (L.triangularView<Eigen::Lower>() * sums.segment(1, F)).eval();
  Eigen::MatrixXd second(F, F);
  for (Index i = 0, row = 1 + F; i < F; ++i)
    for (Index j = 0; j <= i; ++j) second(i, j) = second(j, i) = sums(row++);
  second = (L * second * L.transpose()).eval();
  for (Index i = 0, row = 1 + F; i < F; ++i)
    for (Index j = 0; j <= i; ++j) sums(row++) = second(i, j);
}

KernelScratch::KernelScratch(const FactoredMixture& mixture) : components_(mixture.components().count) {
  const em::Kernels& kernels = mixture.kernels();
  const Index lanes = (2 + components_ * kernels.entries) * em::most_lanes;
  const Index work_padded = (kernels.work + em::most_lanes - 1) / em::most_lanes * em::most_lanes;
  const Index densities = (components_ + 1) * block_size, others = 3 * block_size + lanes + work_padded;
  memory_ = AlignedBuffer::unset(densities + others);
  scratch_.relative = memory_.data();
  scratch_.sum = scratch_.relative + densities;
  std::fill_n(scratch_.sum, others, 0.0);
  scratch_.log_density = scratch_.sum + block_size;
  noise_ = scratch_.log_density + block_size;
  scratch_.lanes = noise_ + block_size;
  scratch_.work = scratch_.lanes + lanes;
}

}  // namespace modebank
