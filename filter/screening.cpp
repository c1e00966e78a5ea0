#include "filter/screening.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <limits>

namespace modebank {

double spectral_radius(const LinearModel& model) {
  if (!model.A.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd full = Eigen::MatrixXd::Identity(model.A.rows(), model.A.cols()) + model.A;
  return full.eigenvalues().cwiseAbs().maxCoeff();
}

std::string screening_reason(const LinearStructure& structure, const ModeEstimate& mode) {
  if (mode.effective_transitions < static_cast<double>(structure.regressors() + 1)) return "starved";
  if (!(spectral_radius(unpack(structure, mode.theta)) <= 1.0 + spectral_radius_slack)) return "unstable";
  return "";
}

std::string describe(const std::vector<ScreenedMode>& screened) {
  std::string text;
  for (const ScreenedMode& mode : screened)
    text += fmt::format("{}component {} {} (weight {:.3g}, spectral radius {:.6g})", text.empty() ? "" : ", ",
                        mode.component, mode.reason, mode.weight, mode.spectral_radius);
  return text;
}

}  // namespace modebank
