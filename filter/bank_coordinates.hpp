#pragma once

#include <Eigen/Core>

#include "filter/bank.hpp"
#include "filter/switching_regression.hpp"

namespace modebank {

/// Unconstrained coordinates of everything that refinement learns about a bank, relative to one bank, the origin:
///   theta_j       = theta0_j + unit z (one coordinate per parameter);
///   Q_j           = L0 M M' L0' with L0 L0' = Q0_j, M lower triangular, exp(z) on its diagonal (log-Cholesky: Pinheiro
///                   & Bates 1996);
///   R_ii          = bound_i + (R0_ii - bound_i) exp(z);
///   row i of T    proportional to T0_ij exp(z_j), z = 0 for its largest entry.
/// Shared parts have one set of coordinates. Initial probabilities and what else a bank holds stay as they are.
class BankCoordinates {
 public:
  /// `theta_unit`: p x K, positive (of shared thetas the first column counts). `R_bound`: n_y, or empty: R is known.
  BankCoordinates(Bank origin, SharedParts shared, Eigen::MatrixXd theta_unit, Eigen::VectorXd R_bound);

  Index size() const;
  const Bank& origin() const { return origin_; }
  /// `at`: size(); zero is the origin.
  Bank decode(const Eigen::VectorXd& at) const;

 private:
  Bank origin_;
  SharedParts shared_;
  Eigen::MatrixXd theta_unit_;
  Eigen::VectorXd R_bound_;

  Index thetas() const { return shared_ == SharedParts::theta ? 1 : origin_.mode_count(); }
  Index noises() const { return shared_ == SharedParts::noise ? 1 : origin_.mode_count(); }
  const double* set_theta(const double* at, Bank& bank) const;
  const double* set_process_noise(const double* at, Bank& bank) const;
  const double* set_measurement_noise(const double* at, Bank& bank) const;
  void set_transition(const double* at, Bank& bank) const;
};

}  // namespace modebank
