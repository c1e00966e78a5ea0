#pragma once

#include "filter/bank.hpp"
#include "filter/switching_regression.hpp"

namespace modebank {

/// The modes, T and first modes of `model` put in place of a bank's, everything else as there. Standard errors are not
/// known yet.
Bank with_modes(const Bank& frame, const SwitchingRegression& model);

}  // namespace modebank
