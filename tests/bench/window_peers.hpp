#pragma once

#include <cstdint>
#include <vector>

#include "ident/model/local_model.hpp"

namespace modebank::bench {

/// Samples of one state and two inputs, and their increments.
struct PeerData {
  std::vector<double> x, left, right, increment;
};

inline constexpr int peer_length = 25;

/// theta and the upper triangle of a 3 x 3 covariance.
struct PeerFit {
  double theta[3];
  double covariance[6];
};

/// The first version that a user would write: one ceres::Problem per window with automatic derivatives, DENSE_QR and
/// ceres::Covariance.
void fit_naive_ceres(const PeerData& data, Loss loss, double scale, Index windows, PeerFit* fits);

/// ceres::TinySolver on sign(r) sqrt(rho), started from the result of the previous window. The covariance is that of
/// the reweighted problem.
void fit_tiny_solver(const PeerData& data, Loss loss, double scale, Index windows, PeerFit* fits);

}  // namespace modebank::bench
