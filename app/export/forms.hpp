#pragma once

#include <string>

#include "app/export/exported_bank.hpp"

/// One function per form of `modebank export`. docs/reference/export.md describes each form.
namespace modebank::app {

/// Version of the JSON form. New members increase the minor number; other changes increase the major number.
inline constexpr const char* export_schema_version = "4.0";

std::string to_json(const ExportedBank& bank);

/// C99 header and source. `stem`: file name without extension; the identifiers begin with it.
struct CFiles {
  std::string header, source;
};
/// Throws DataError if the C code does not support a part of the filter. The message names this part.
CFiles to_c(const ExportedBank& bank, const std::string& stem);

}  // namespace modebank::app
