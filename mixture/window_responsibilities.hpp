#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "mixture/features.hpp"
#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// Posterior component probabilities of all windows, K x M; NaN for windows that are neither clustered nor assigned.
/// They are stored (as read from an archive), or recomputed block by block on each reading to save K x M memory. Both
/// ways give the same numbers to the last bit.
class WindowResponsibilities {
 public:
  WindowResponsibilities() = default;
  WindowResponsibilities(Eigen::MatrixXd stored) : stored_(std::move(stored)), windows_(stored_.cols()) {}
  /// Responsibilities of two clouds: the clustered windows, and the windows that are assigned afterwards. The windows
  /// of each cloud must be in increasing order and below `windows`; otherwise throws std::invalid_argument.
  WindowResponsibilities(GaussianMixture mixture, FeatureCloud clustered, FeatureCloud assigned, Eigen::Index windows);

  Eigen::Index components() const;
  Eigen::Index windows() const { return windows_; }
  /// Probabilities of windows first to first + count - 1, K x count.
  Eigen::MatrixXd block(Eigen::Index first, Eigen::Index count) const;
  Eigen::MatrixXd all() const { return block(0, windows_); }
  /// Adds the probabilities of component `absorbed` to those of `into`. The indices of later components decrease by
  /// one.
  WindowResponsibilities merged(Eigen::Index into, Eigen::Index absorbed) &&;

 private:
  struct Source {
    GaussianMixture mixture;
    std::array<FeatureCloud, 2> clouds;
  };
  Eigen::MatrixXd stored_;
  std::shared_ptr<const Source> source_;
  Eigen::MatrixXd sums_;  ///< merged components x fitted components, with entries one or zero; empty without a merge
  Eigen::Index windows_ = 0;

  Eigen::Index fitted() const { return source_ ? source_->mixture.components() : stored_.rows(); }
  Eigen::MatrixXd fitted_block(Eigen::Index first, Eigen::Index count) const;
};

/// Writes the most probable component of every window of the cloud into `labels` (M); -1 if noise is more probable than
/// any component.
void label_windows(const GaussianMixture& mixture, const FeatureCloud& cloud, Eigen::VectorXi& labels);

}  // namespace modebank
