#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/hdf5/array.hpp"

namespace modebank::hdf5 {

/// Every value of an array, nested by its shape. A table becomes a list of row objects. Integers stay exact. Values
/// that JSON lacks (NaN, infinities, references, opaque bytes) become null. Text that is not UTF-8 is repaired.
nlohmann::json to_json(const StoredArray& array);
/// The same for a range of rows.
nlohmann::json to_json(const StoredArray& array, const Rows& rows);

/// A table's columns in order, with the names of the row objects.
std::vector<std::string> column_names(const StoredArray& table);

/// Text as JSON, with U+FFFD for bytes that are not UTF-8.
nlohmann::json text_json(const std::string& text);

}  // namespace modebank::hdf5
