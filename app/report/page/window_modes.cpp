#include "app/report/page/window_modes.hpp"

#include <map>

namespace modebank {

namespace {

int mode_of(const Window& window, Eigen::Index length, const Eigen::MatrixXd& probability) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(probability.rows());
  for (Eigen::Index k = window.start + 1; k <= window.start + length && k < probability.cols(); ++k)
    if (!probability.col(k).array().isNaN().any()) sum += probability.col(k);
  Eigen::Index best = -1;
  return sum.size() > 0 && sum.maxCoeff(&best) > 0.0 ? static_cast<int>(best) : -1;
}

}  // namespace

Eigen::VectorXi window_modes(const std::vector<Window>& windows, Eigen::Index length,
                             const FilterEvaluation& evaluation) {
  std::map<Eigen::Index, std::vector<std::size_t>> of_runs;  // in this order, each run is read only once
  for (std::size_t i = 0; i < windows.size(); ++i) of_runs[windows[i].run].push_back(i);
  Eigen::VectorXi modes(static_cast<Eigen::Index>(windows.size()));
  for (const auto& [run, positions] : of_runs)
    evaluation.with_run(static_cast<std::size_t>(run), {"mode_probability"},
                        [&, &own = positions](const RunEvaluation& said) {
                          for (const std::size_t i : own)
                            modes(static_cast<Eigen::Index>(i)) = mode_of(windows[i], length, said.mode_probability);
                        });
  return modes;
}

}  // namespace modebank
