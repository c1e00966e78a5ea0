#include "filter/start_moments.hpp"

#include <Eigen/QR>
#include <algorithm>

namespace modebank {

StartMoments start_moments(const Bank& bank) {
  double largest = bank.R.diagonal().maxCoeff();
  for (const Mode& mode : bank.modes) largest = std::max(largest, mode.Q.diagonal().maxCoeff());
  const Eigen::Index n = bank.structure.states;
  const Eigen::MatrixXd C_pinv = bank.C.completeOrthogonalDecomposition().pseudoInverse();
  Eigen::MatrixXd P = C_pinv * bank.R * C_pinv.transpose();
  const Eigen::MatrixXd unobserved = Eigen::MatrixXd::Identity(n, n) - C_pinv * bank.C;
  if (bank.C.rows() < n) P += unobserved_variance_factor * largest * unobserved;
  return {C_pinv, 0.5 * (P + P.transpose())};
}

}  // namespace modebank
