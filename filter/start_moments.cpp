#include "filter/start_moments.hpp"

#include <Eigen/QR>
#include <algorithm>

namespace modebank {

namespace {

StartMoments measured_lags(const Bank& bank) {
  const Eigen::Index n = bank.structure.dimension(), n_y = bank.R.rows();
  StartMoments moments{Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd::Zero(n, n)};
  for (Eigen::Index i = 0; i + n_y <= n; i += n_y) moments.covariance.block(i, i, n_y, n_y) = bank.R;
  return moments;
}

}  // namespace

StartMoments start_moments(const Bank& bank) {
  if (bank.structure.state_lags > 1) return measured_lags(bank);
  double largest = bank.R.diagonal().maxCoeff();
  for (const Mode& mode : bank.modes) largest = std::max(largest, mode.Q.diagonal().maxCoeff());
  const Eigen::Index n = bank.structure.dimension();
  const Eigen::MatrixXd C_pinv = bank.C.completeOrthogonalDecomposition().pseudoInverse();
  Eigen::MatrixXd P = C_pinv * bank.R * C_pinv.transpose();
  const Eigen::MatrixXd unobserved = Eigen::MatrixXd::Identity(n, n) - C_pinv * bank.C;
  if (bank.C.rows() < n) P += unobserved_variance_factor * largest * unobserved;
  return {C_pinv, 0.5 * (P + P.transpose())};
}

}  // namespace modebank
