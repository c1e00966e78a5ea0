#pragma once

#include <Eigen/Core>

#include "ident/model/transitions.hpp"

namespace modebank {

double median(Eigen::VectorXd values);  ///< Median: the mean of the two middle values for an even count; NaN if empty.

/// 1.4826 times the median absolute deviation from the median; consistent for a Gaussian's standard deviation.
double normalised_mad(const Eigen::VectorXd& values);

/// Residual standard deviations and their lower bounds, n each.
struct NoiseScale {
  Eigen::VectorXd sigma;
  Eigen::VectorXd floor;
};

/// Residual standard deviation per state: normalised_mad times sqrt(N / (N - lost)). r are least-squares residuals (N x
/// n). The least-squares fit costs each state `lost` degrees of freedom. NaN if N <= lost.
Eigen::VectorXd robust_scale(const Eigen::Ref<const Eigen::MatrixXd>& r, double lost);

/// robust_scale of a linear regression.
Eigen::VectorXd robust_scale(const Transitions& transitions, const Decomposition& decomposition);

/// Lower bound of sigma per state: 1e-3 of the global residual standard deviation. For noise-free data the bound is the
/// states' rounding error. For constant zero data the bound is 1, so that whitened residuals stay finite.
Eigen::VectorXd scale_floor(const Recording& recording, const LinearStructure& structure,
                            const Eigen::VectorXd& global_noise_variance);

}  // namespace modebank
