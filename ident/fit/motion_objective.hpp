#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/fit/loss.hpp"
#include "ident/fit/motion_residuals.hpp"
#include "ident/fit/prior.hpp"

namespace modebank {

/// What a motion model's fit minimises: 1/2 sum_k w_k rho(|r_k / sigma|^2) + 1/2 |(theta - m) / sd|^2 over the unknowns
/// of ModelResiduals. Refers to residuals and prior, which must outlive it. Evaluations share their memory and allocate
/// nothing after the first: an objective belongs to one thread. Sums are written out entry by entry: windows are small,
/// and matrix expressions of unknown size cost more than the arithmetic.
class ModelObjective {
 public:
  /// `sigma`: n positive entries; `prior` may be null.
  ModelObjective(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const ParameterPrior* prior);

  Index unknowns() const { return residuals_.unknowns(); }
  Index rows() const { return residuals_.rows() + prior_rows(); }
  const MotionModel& model() const { return residuals_.model(); }

  double cost(const Eigen::VectorXd& at, const RobustLoss& loss) const;

  /// The objective around a point.
  struct Expansion {
    double cost = 0.0;
    double psi_square = 0.0;  ///< sum w |rho' r / sigma|^2 + |(theta - m) / sd|^2: what the gradient is a projection of
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;  ///< without the model's own curvature; positive semidefinite without the loss'
  };
  enum class LossCurvature { taken, left_out };
  void expand(const Eigen::VectorXd& at, const RobustLoss& loss, LossCurvature curvature, Expansion& expansion) const;

  /// rows() values f with 1/2 |f|^2 the objective, r sqrt(w rho(s) / s) per sample and then the prior's; their
  /// derivatives (row-major) if `jacobian` is not null.
  void least_squares_rows(const double* at, const RobustLoss& loss, double* f, double* jacobian) const;

 private:
  Index samples() const { return residuals_.samples(); }
  Index prior_rows() const { return prior_ ? prior_->mean.size() : 0; }
  /// Fills r_ and, where wanted, J_ in units of sigma.
  void linearise(const double* at, bool with_derivatives) const;
  void add_sample(const double* r, const double* J, double weight, double curvature, double s, Expansion& e) const;
  void add_prior(const Eigen::VectorXd& at, Expansion& e) const;

  const ModelResiduals& residuals_;
  Eigen::VectorXd inverse_sigma_;
  const ParameterPrior* prior_;
  mutable Eigen::VectorXd r_;
  mutable RowMajorJacobian J_;
  mutable std::vector<double> pull_;  // J_k' r_k
};

}  // namespace modebank
