#pragma once

#include <Eigen/Core>

#include "filter/bank.hpp"

namespace modebank {

/// Directions of the state that one measurement leaves open start with this multiple of the largest variance of Q and
/// R: wide against what the filter will learn, and close enough to it to keep the arithmetic sound.
inline constexpr double unobserved_variance_factor = 1e4;

/// How a filter starts from its first measurement: x[0] = gain y[0]. With lagged states it starts from the measurements
/// of all of z: gain I, and R for each sample.
struct StartMoments {
  Eigen::MatrixXd gain;        ///< n x n_y, the pseudo-inverse C+; n x n with lagged states
  Eigen::MatrixXd covariance;  ///< n x n, C+ R C+' (+ wide variance where C sees nothing); R itself for C = I
};

StartMoments start_moments(const Bank& bank);

}  // namespace modebank
