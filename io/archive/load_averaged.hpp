#pragma once

#include "ident/data/streams.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The columns of an archive's data that were averaged to data.rate_hz; empty if there are none. The other parts of the
/// file are not decoded. Throws as load_bank does.
AveragedColumns load_averaged(const OpenArchive& archive);

}  // namespace modebank
