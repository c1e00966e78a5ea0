#pragma once

#include <optional>

#include "ident/lag/report.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The lag report of an archive made with data.lag_s = auto; empty for others. Decodes nothing else of the file. Throws
/// as load_bank does.
std::optional<LagReport> load_lag(const OpenArchive& archive);

}  // namespace modebank
