#pragma once

#include <Eigen/Core>

namespace modebank {

namespace detail {
inline const Eigen::VectorXd no_weights;
inline const Eigen::MatrixXd no_covariances;
}  // namespace detail

/// Points to be clustered or evaluated, with what is known of each. Refers to its parts, which must outlive it: parts
/// that end with the expression are refused by the compiler.
struct PointSet {
  const Eigen::MatrixXd& points;       ///< F x N
  const Eigen::VectorXd& weights;      ///< N, nonnegative; empty: all one
  const Eigen::MatrixXd& covariances;  ///< F*F x N, each column the covariance of that point's error; empty: no errors

  PointSet(const Eigen::MatrixXd& points_, const Eigen::VectorXd& weights_ = detail::no_weights,
           const Eigen::MatrixXd& covariances_ = detail::no_covariances)
      : points(points_), weights(weights_), covariances(covariances_) {}
  PointSet(Eigen::MatrixXd&&, const Eigen::VectorXd& = detail::no_weights,
           const Eigen::MatrixXd& = detail::no_covariances) = delete;
  PointSet(const Eigen::MatrixXd&, Eigen::VectorXd&&, const Eigen::MatrixXd& = detail::no_covariances) = delete;
  PointSet(const Eigen::MatrixXd&, const Eigen::VectorXd&, Eigen::MatrixXd&&) = delete;

  Eigen::Index features() const { return points.rows(); }
  Eigen::Index count() const { return points.cols(); }
  bool has_errors() const { return covariances.size() > 0; }
};

}  // namespace modebank
