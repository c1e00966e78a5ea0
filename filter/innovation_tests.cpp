#include "filter/innovation_tests.hpp"

#include <cmath>

#include "filter/calibration.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

ResidualTests test_innovations(const Trajectory& run, const RunEvaluation& evaluation,
                               const ResidualTestOptions& options) {
  // Sample k + 1 closes transition k, whose input is u[k].
  const Eigen::MatrixXd z = evaluation.pit.rightCols(run.transitions()).unaryExpr([](double pit) {
    return std::isnan(pit) ? not_a_number : normal_score(pit);
  });
  return test_residuals(z, run.input.leftCols(run.transitions()), options);
}

}  // namespace modebank
