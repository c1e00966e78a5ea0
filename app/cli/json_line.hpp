#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace modebank::app {

/// A line of NDJSON; discarded (is_discarded()) when it is none. NaN and Infinity, which many writers leave bare, are
/// null.
nlohmann::json parse_json_line(std::string_view line);

/// A member of an object as a field of a text file would have it: empty when it is null or not there. Throws DataError
/// for one that is neither a number nor a text.
std::string json_field(const nlohmann::json& object, const std::string& name);

}  // namespace modebank::app
