#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/hdf5/array.hpp"

namespace modebank::hdf5 {

/// Every value of an array as JSON, nested by the array's shape. A table becomes a list of row objects. Integers stay
/// exact. NaN, infinities, references and opaque bytes become null, because JSON lacks them. Invalid UTF-8 is repaired.
nlohmann::json to_json(const StoredArray& array);
/// JSON of a range of rows.
nlohmann::json to_json(const StoredArray& array, const Rows& rows);

/// The names of a table's columns in order. The row objects use the same names.
std::vector<std::string> column_names(const StoredArray& table);

/// Text as JSON. Bytes that are not UTF-8 become U+FFFD.
nlohmann::json text_json(const std::string& text);

}  // namespace modebank::hdf5
