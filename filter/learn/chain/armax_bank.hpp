#pragma once

#include <Eigen/Core>
#include <optional>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/lag/armax.hpp"
#include "ident/lag/structure.hpp"

namespace modebank {

/// The structure of a row of the table, with the delays that were found for the inputs.
ArmaxStructure armax_of(const StructureScore& row, const FoundStructure& found, Index inputs, bool intercept);

/// One Kalman filter with theta, Q and R of the linear stage. Differences become levels with a pole at 1 and without a
/// constant.
Bank bank_of(const Recording& recording, const ArmaxFit& fit, const std::optional<Eigen::VectorXd>& stated_R);

/// bank_of the fit of this structure to the training runs; empty where the runs are too short for it.
std::optional<Bank> learn_armax(const Recording& recording, const ArmaxStructure& structure,
                                const std::optional<Eigen::VectorXd>& stated_R);

}  // namespace modebank
