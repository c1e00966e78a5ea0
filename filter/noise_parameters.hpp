#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "ident/trajectory.hpp"

namespace modebank {

/// Process and measurement noise of one filter.
struct NoiseCovariances {
  Eigen::MatrixXd Q;  ///< n x n
  Eigen::MatrixXd R;  ///< n x n, diagonal
};

/// Unconstrained coordinates of Q (full) and R (diagonal, bounded below) for the maximum likelihood search.
///   Q = D^(1/2) (L L' + 1e-12 I) D^(1/2), L lower triangular with exp(l_ii) on its diagonal (log-Cholesky: Pinheiro &
///   Bates 1996), D = diag(scale); the small share keeps Q positive where the data ask for none.
///   R_ii = bound_i + scale_i exp(rho_i), or bound_i where the output is held at its bound.
class NoiseParametrisation {
 public:
  /// `scale`: n typical residual variances, positive; `bound`: n lower bounds of R's diagonal.
  NoiseParametrisation(Eigen::VectorXd scale, Eigen::VectorXd bound)
      : scale_(std::move(scale)), bound_(std::move(bound)), held_(scale_.size(), false) {}

  Index size() const;
  NoiseCovariances decode(const double* coordinates) const;
  /// Q = q_share D, R = bound + r_share D where free.
  Eigen::VectorXd coordinates(double q_share, double r_share) const;
  bool held(Index output) const { return held_[output]; }
  /// The same with one more output held at its bound, and the coordinates that remain.
  NoiseParametrisation hold(Index output) const;
  Eigen::VectorXd without(const Eigen::VectorXd& coordinates, Index output) const;

 private:
  Index triangle() const { return scale_.size() * (scale_.size() + 1) / 2; }
  Index position_of(Index output) const;

  Eigen::VectorXd scale_, bound_;
  std::vector<bool> held_;
};

}  // namespace modebank
