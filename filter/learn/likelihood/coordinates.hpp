#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank {

/// Which parameters of a bank are estimated beside Q, and their units.
struct FreeParameters {
  Eigen::MatrixXd theta_unit = {};   ///< p x K, or p x 1 for one theta of all modes; positive; empty if theta is known
  bool Q_by_one_factor = false;      ///< one common factor on every Q, instead of separate Q
  Eigen::VectorXd least_Q = {};      ///< n, lower bounds of every Q's diagonal [state unit^2]; empty if there are none
  std::vector<Eigen::Index> R = {};  ///< outputs whose variance is estimated
  Eigen::VectorXd least_R = {};      ///< n_y, lower bounds of R's diagonal [state unit^2]
  bool transition = true;            ///< true: T is estimated; false: T is known
};

/// Layout of a bank's free parameters in one vector:
/// - theta of every mode;
/// - the lower triangle of every Q (column by column, measured states);
/// - R of the estimated outputs;
/// - T row by row.
struct ParameterPlaces {
  Eigen::Index parameters = 0;  ///< p; 0 if theta is known
  Eigen::Index triangle = 0;    ///< n (n + 1) / 2
  Eigen::Index modes = 0;
  Eigen::Index outputs = 0;  ///< number of outputs with estimated R
  bool transition = false;

  Eigen::Index theta(Eigen::Index mode) const { return mode * parameters; }
  Eigen::Index Q(Eigen::Index mode) const { return modes * parameters + mode * triangle; }
  Eigen::Index R() const { return Q(modes); }
  Eigen::Index T(Eigen::Index from) const { return R() + outputs + from * modes; }
  Eigen::Index size() const { return T(transition ? modes : 0); }
};

/// Unconstrained coordinates of all estimated parameters of a bank, relative to one bank, the origin:
///   theta_j       = theta0_j + unit z (one coordinate per parameter);
///   Q_j           = L0 M M' L0' with L0 L0' = Q0_j, M lower triangular, exp(z) on its diagonal (log-Cholesky: Pinheiro
///                   & Bates 1996), its diagonal at least least_Q; or Q0_j exp(z) with one z for all modes;
///   R_ii          = least_R_i + max(R0_ii - least_R_i, 0) exp(z);
///   row i of T    proportional to T0_ij exp(z_j), z = 0 for its largest entry.
/// Initial probabilities and all other fields of the bank, with the weights of a logit, are constant.
class BankCoordinates {
 public:
  BankCoordinates(Bank origin, FreeParameters free);

  Eigen::Index size() const;
  const Bank& origin() const { return origin_; }
  const Eigen::VectorXd& least_R() const { return free_.least_R; }
  bool has_one_theta() const { return free_.theta_unit.cols() == 1; }
  /// The bank at these coordinates. `at`: size() entries; zero is the origin.
  Bank decode(const Eigen::VectorXd& at) const;

  ParameterPlaces places() const;
  /// Derivative of the free parameters with respect to the coordinates at the origin, places().size() x size().
  Eigen::MatrixXd jacobian() const;

 private:
  Bank origin_;
  FreeParameters free_;

  const double* set_theta(const double* at, Bank& bank) const;
  const double* set_process_noise(const double* at, Bank& bank) const;
  const double* set_measurement_noise(const double* at, Bank& bank) const;
  void set_transition(const double* at, Bank& bank) const;
  Eigen::VectorXd parameters_of(const Bank& bank) const;
};

}  // namespace modebank
