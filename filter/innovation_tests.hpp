#pragma once

#include "filter/evaluate.hpp"
#include "ident/residual_tests.hpp"

namespace modebank {

/// Residual tests of a filter's one-step predictions over one run: the residuals are z = Phi^-1(pit) of each output,
/// which are standard normal and white for a true filter of any kind (innovations of a mixture are not Gaussian), and
/// input lag 0 is the input of the predicted transition. Throws std::invalid_argument when sizes disagree.
ResidualTests test_innovations(const Trajectory& run, const RunEvaluation& evaluation,
                               const ResidualTestOptions& options = {});

}  // namespace modebank
