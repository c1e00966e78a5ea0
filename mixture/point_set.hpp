#pragma once

#include <Eigen/Core>

namespace modebank {

namespace detail {
inline const Eigen::VectorXd no_weights;
inline const Eigen::MatrixXd no_covariances;
}  // namespace detail

/// Points to be clustered or evaluated, with weights and errors. Holds references to these parts, which must outlive
/// it. The compiler rejects temporaries.
struct PointSet {
  const Eigen::MatrixXd& points;       ///< F x N, one point per column
  const Eigen::VectorXd& weights;      ///< N, nonnegative; if empty, all weights are one
  const Eigen::MatrixXd& covariances;  ///< F*F x N, each column the covariance of that point's error; empty without
                                       ///< errors

  /// F, standard deviation of a typical point's error; the unit of that feature in the fit. 0 or empty if unknown
  const Eigen::VectorXd& typical_error;

  PointSet(const Eigen::MatrixXd& points_, const Eigen::VectorXd& weights_ = detail::no_weights,
           const Eigen::MatrixXd& covariances_ = detail::no_covariances,
           const Eigen::VectorXd& typical_error_ = detail::no_weights)
      : points(points_), weights(weights_), covariances(covariances_), typical_error(typical_error_) {}
  PointSet(Eigen::MatrixXd&&, const Eigen::VectorXd& = detail::no_weights,
           const Eigen::MatrixXd& = detail::no_covariances, const Eigen::VectorXd& = detail::no_weights) = delete;
  PointSet(const Eigen::MatrixXd&, Eigen::VectorXd&&, const Eigen::MatrixXd& = detail::no_covariances,
           const Eigen::VectorXd& = detail::no_weights) = delete;
  PointSet(const Eigen::MatrixXd&, const Eigen::VectorXd&, Eigen::MatrixXd&&,
           const Eigen::VectorXd& = detail::no_weights) = delete;
  PointSet(const Eigen::MatrixXd&, const Eigen::VectorXd&, const Eigen::MatrixXd&, Eigen::VectorXd&&) = delete;

  Eigen::Index features() const { return points.rows(); }
  Eigen::Index count() const { return points.cols(); }
  bool has_errors() const { return covariances.size() > 0; }
};

}  // namespace modebank
