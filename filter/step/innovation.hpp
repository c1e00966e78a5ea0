#pragma once

#include <Eigen/Core>

#include "filter/step/equations/arithmetic.hpp"
#include "filter/step/equations/partial_sensor.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

/// Upper limit of normalised squares.
inline constexpr double largest_nis = 1e300;

/// The innovation of a predicted mixture, and its normalised square. Memory is allocated once.
struct CombinedInnovation {
  Eigen::VectorXd innovation;  ///< n_y, e = y - C x; NaN for missing signals
  double nis = 0.0;            ///< e' S^-1 e of the available signals; NaN if there are none

  explicit CombinedInnovation(Eigen::Index n_y)
      : innovation(n_y), covariance_(n_y, n_y), residual_(n_y), cholesky_(n_y) {}

  void observe(const Eigen::MatrixXd& C, const Eigen::VectorXd& x, const Eigen::MatrixXd& S,
               const Eigen::Ref<const Eigen::VectorXd>& y) {
    small::multiply(innovation, C, x);
    innovation = y - innovation;
    normalise(S, y);
  }
  /// The square of an `innovation` that is given.
  void normalise(const Eigen::MatrixXd& S, const Eigen::Ref<const Eigen::VectorXd>& y) {
    covariance_ = S;
    residual_ = innovation;
    Eigen::Index missing = 0;
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (is_missing(y(i))) {
        detach(covariance_, i);
        residual_(i) = 0.0;
        innovation(i) = not_a_number;
        ++missing;
      }
    cholesky_.factorise(covariance_);
    cholesky_.decorrelate(residual_);
    nis = cholesky_.squared_distance(residual_);
    if (!(nis < largest_nis)) nis = largest_nis;
    if (missing == y.size()) nis = not_a_number;
  }

 private:
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd residual_;
  small::Ldl<Eigen::Dynamic> cholesky_;
};

}  // namespace modebank
