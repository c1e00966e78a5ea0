#pragma once

#include <optional>

#include "ident/lag/report.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The lag report of an archive with `data.lag_s = auto`. Empty for other archives. The other parts of the file are not
/// decoded. Throws the same exceptions as load_bank.
std::optional<LagReport> load_lag(const OpenArchive& archive);

}  // namespace modebank
