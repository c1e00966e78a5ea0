#pragma once

#include "ident/data/streams.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The columns of an archive's data that were averaged to data.rate_hz; empty if none was. Decodes nothing else of the
/// file. Throws as load_bank does.
AveragedColumns load_averaged(const OpenArchive& archive);

}  // namespace modebank
