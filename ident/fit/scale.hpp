#pragma once

#include <Eigen/Core>

#include "ident/model/transitions.hpp"

namespace modebank {

double median(Eigen::VectorXd values);  ///< mean of the two middle ones for an even count; NaN for none

/// 1.4826 times the median absolute deviation from the median: consistent for the standard deviation of a Gaussian.
double normalised_mad(const Eigen::VectorXd& values);

/// The same of a sample in which value i stands for weights(i) > 0 values.
double normalised_mad(const Eigen::VectorXd& values, const Eigen::VectorXd& weights);

/// Residual standard deviations and what no estimate of them may fall below, n each.
struct NoiseScale {
  Eigen::VectorXd sigma;
  Eigen::VectorXd floor;
};

/// Residual standard deviation per state from least-squares residuals r (N x n, not multiplied by roots of weights)
/// that cost each state `lost` degrees of freedom: normalised_mad, with the sample weights where there are some (N, or
/// none), times sqrt(N / (N - lost)). NaN where N <= lost.
Eigen::VectorXd robust_scale(const Eigen::Ref<const Eigen::MatrixXd>& r, const Eigen::VectorXd& weights, double lost);

/// The same of a linear regression.
Eigen::VectorXd robust_scale(const Transitions& transitions, const Decomposition& decomposition);

/// What no sigma may fall below, per state: 1e-3 of the global residual standard deviation. Noise-free data keep a
/// floor at the states' rounding error, and constant zero data one of 1, so that whitened residuals stay finite.
Eigen::VectorXd scale_floor(const Recording& recording, const LinearStructure& structure,
                            const Eigen::VectorXd& global_noise_variance);

}  // namespace modebank
