#pragma once

#include <optional>

#include "ident/lag/report.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The lag report of an archive with data.lag_s = auto; empty for other archives. The other parts of the file are not
/// decoded. Throws as load_bank does.
std::optional<LagReport> load_lag(const OpenArchive& archive);

}  // namespace modebank
