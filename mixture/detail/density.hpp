#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "mixture/detail/cloud.hpp"
#include "mixture/detail/kernels/kernels.hpp"
#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// A mixture in the layout of the vector kernels, with its covariances factored once and the matching kernels.
class FactoredMixture {
 public:
  /// Chooses kernels for points with or without errors. Throws NotPositiveDefinite if a covariance is not positive
  /// definite; the message gives the first such component.
  FactoredMixture(const GaussianMixture& mixture, bool errors);

  em::Components components() const;
  const em::Kernels& kernels() const { return kernels_; }
  bool has_noise() const { return noise_; }
  double log_noise() const { return log_noise_; }  ///< log of weight times density of the noise component

  /// Converts a component's sums in place into sums of r, r d and r d d' (em::Kernels). Kernels with errors sum in
  /// units of W. For central components, kernels without errors sum about the origin.
  void to_plain_sums(Eigen::Index component, Eigen::Ref<Eigen::VectorXd> sums) const;

 private:
  Eigen::MatrixXd means_;
  bool diagonal_;
  bool noise_;
  double log_noise_ = 0.0;
  em::Kernels kernels_;
  Eigen::Index stride_ = 0;
  std::vector<double> whitening_;
  std::unique_ptr<bool[]> central_;
  std::vector<Eigen::MatrixXd> cholesky_;  ///< lower Cholesky factors; set only with errors
  Eigen::VectorXd log_constants_;
};

/// Working memory of the kernels, and the lane sums of a pass.
class KernelScratch {
 public:
  explicit KernelScratch(const FactoredMixture& mixture);

  const em::Scratch& scratch() const { return scratch_; }
  Eigen::Map<const Eigen::Array<double, block_size, Eigen::Dynamic>> relative() const {
    return {scratch_.relative, block_size, components_};
  }
  Eigen::Map<const Eigen::Array<double, block_size, 1>> sum() const {
    return Eigen::Map<const Eigen::Array<double, block_size, 1>>(scratch_.sum);
  }
  Eigen::Map<const Eigen::Array<double, block_size, 1>> log_density() const {
    return Eigen::Map<const Eigen::Array<double, block_size, 1>>(scratch_.log_density);
  }
  double* noise() { return noise_; }  ///< a column of values for em::Block::noise

 private:
  Eigen::Index components_;
  AlignedBuffer memory_;
  em::Scratch scratch_;
  double* noise_;
};

/// Replaces the logarithm of a zero weight.
inline constexpr double log_zero = -1e300;

}  // namespace modebank
