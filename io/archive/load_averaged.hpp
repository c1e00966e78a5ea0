#pragma once

#include "ident/data/streams.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The columns of an archive's data that were averaged to `data.rate_hz`. Empty if no column was averaged. The other
/// parts of the file are not decoded. Throws the same exceptions as load_bank.
AveragedColumns load_averaged(const OpenArchive& archive);

}  // namespace modebank
