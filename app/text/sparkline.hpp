#pragma once

#include <Eigen/Core>
#include <string>

#include "app/text/terminal.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

/// One character per value in [0, 1], by height: eighths of a block, or " .:-=+*#%@" where the terminal has no UTF-8.
/// A value that is not finite is "?".
std::string sparkline(const Eigen::VectorXd& values, bool utf8);

/// The bank's mode probabilities over the judged runs (judged_role), one line per mode. Runs stand side by side, each
/// with a width by its share of the samples. Runs that do not fit are left out. Empty without an evaluation of the
/// bank.
std::string mode_strip_text(const Archive& archive, const Terminal& terminal);

}  // namespace modebank::app
