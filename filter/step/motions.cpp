#include "filter/step/motions.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/linalg.hpp"

namespace modebank {

using Eigen::Index;

Index motion_count(const Bank& bank) {
  return bank.motion.empty() ? bank.mode_count() : *std::max_element(bank.motion.begin(), bank.motion.end()) + 1;
}

double stay_in_motion(const Bank& bank, Index motion) {
  constexpr double never_entered = 1e-12;  // probability of a mode that the chain only leaves
  const Eigen::MatrixXd& T = bank.transition.matrix();
  const Index K = T.rows();
  Eigen::MatrixXd equations(K + 1, K);
  equations << T.transpose() - Eigen::MatrixXd::Identity(K, K), Eigen::RowVectorXd::Ones(K);
  // The solution of least norm, where T does not join all modes.
  const Eigen::VectorXd pi = solve_least_squares(equations, Eigen::VectorXd::Unit(K + 1, K)).cwiseMax(never_entered);
  double used = 0.0, left = 0.0;
  for (Index i = 0; i < K; ++i) {
    if (bank.motion_of(i) != motion) continue;
    used += pi(i);
    for (Index j = 0; j < K; ++j)
      if (bank.motion_of(j) != motion) left += pi(i) * T(i, j);
  }
  return used / left;
}

Index counted_motions(const Bank& bank) {
  constexpr double least_stay = 5.0;  // [samples]
  Index counted = 0;
  for (Index motion = 0; motion < motion_count(bank); ++motion) counted += stay_in_motion(bank, motion) >= least_stay;
  return std::max<Index>(counted, 1);
}

double response_samples(const Bank& single) {
  double least = INFINITY;
  for (const double time_s : single.modes.front().response.value.response_s.reshaped())
    if (time_s < least) least = time_s;
  return std::isfinite(least) && single.dt_s > 0.0 ? least / single.dt_s : 1.0;
}

double least_nats(double samples, double response_samples) {
  return std::max(12.0, 0.02 * samples / std::max(1.0, 0.1 * response_samples));
}

}  // namespace modebank
