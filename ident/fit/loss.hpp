#pragma once

#include <Eigen/Core>
#include <memory>

#include "ident/model/local_model.hpp"

namespace ceres {
class LossFunction;
}

namespace modebank {

/// Tuning constant in units of sigma that gives 95 % efficiency under Gaussian noise in one state (Holland & Welsch
/// 1977). softlone and arctan meet the same condition. The constant of trivial is 1.
double default_loss_scale(Loss loss);

/// rho and its derivatives at s = |r|^2, with r in units of sigma.
struct LossValue {
  double rho = 0.0;
  double weight = 0.0;     ///< rho'(s), the weight of iteratively reweighted least squares; 1 at s = 0
  double curvature = 0.0;  ///< rho''(s)
};

/// A Ceres loss with its tuning constant c in units of sigma. Immutable; all windows and threads share it. arctan is
/// rho(s) = c^2 atan(s / c^2). (Ceres' own argument is c^2.) So c has the unit of a residual for every loss.
class RobustLoss {
 public:
  /// `scale`: 0 selects default_loss_scale. Throws std::invalid_argument for a negative or non-finite scale.
  RobustLoss(Loss loss, double scale);
  ~RobustLoss();
  RobustLoss(RobustLoss&&) noexcept;
  RobustLoss& operator=(RobustLoss&&) noexcept;

  LossValue operator()(double s) const;
  Loss kind() const { return kind_; }
  double scale() const { return scale_; }
  bool convex() const { return kind_ == Loss::trivial || kind_ == Loss::huber || kind_ == Loss::softlone; }
  /// For ceres::Problem::AddResidualBlock, whose parameter is not const. Ceres does not change the loss.
  ceres::LossFunction* ceres_function() const { return function_.get(); }

 private:
  Loss kind_;
  double scale_;
  std::unique_ptr<ceres::LossFunction> function_;
};

/// E[rho'(|z|^2) |z|^2] / n for z ~ N(0, I_n), the limit of the weighted mean square of Gaussian residuals in units of
/// sigma. Dividing by it gives a consistent variance estimate (1 for trivial).
double gaussian_consistency(const RobustLoss& loss, Eigen::Index states);

}  // namespace modebank
