#include "app/report/page/window_modes.hpp"

#include <cmath>

namespace modebank {

Eigen::VectorXi window_modes(const std::vector<Window>& windows, Eigen::Index length,
                             const std::vector<RunEvaluation>& evaluations) {
  Eigen::VectorXi modes = Eigen::VectorXi::Constant(static_cast<Eigen::Index>(windows.size()), -1);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Eigen::MatrixXd& probability = evaluations.at(static_cast<std::size_t>(windows[i].run)).mode_probability;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(probability.rows());
    for (Eigen::Index k = windows[i].start + 1; k <= windows[i].start + length && k < probability.cols(); ++k)
      if (!probability.col(k).array().isNaN().any()) sum += probability.col(k);
    Eigen::Index best = -1;
    if (sum.size() > 0 && sum.maxCoeff(&best) > 0.0) modes(static_cast<Eigen::Index>(i)) = static_cast<int>(best);
  }
  return modes;
}

}  // namespace modebank
