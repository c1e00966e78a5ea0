#pragma once

#include "ident/data/streams.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// Which columns of an archive's data were averaged when they were brought to data.rate_hz; none where nothing was.
/// Nothing else of the file is decoded. Throws as load_bank does.
AveragedColumns load_averaged(const OpenArchive& archive);

}  // namespace modebank
