#pragma once

#include <Eigen/Core>
#include <string>

#include "app/text/terminal.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

/// One character per value in [0, 1]. Its height shows the value: eighths of a block, or " .:-=+*#%@" if the terminal
/// does not support UTF-8. A value that is not finite becomes "?".
std::string sparkline(const Eigen::VectorXd& values, bool utf8);

/// The bank's mode probabilities over the judged runs (judged_role), one line per mode. The runs are side by side. The
/// width of a run is proportional to its number of samples. Runs that do not fit are omitted. Empty if the bank was not
/// evaluated.
std::string mode_strip_text(const Archive& archive, const Terminal& terminal);

}  // namespace modebank::app
