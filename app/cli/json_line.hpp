#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace modebank::app {

/// Parses a line of NDJSON. The result is_discarded() for other text. Many programs write NaN and Infinity; these
/// become null.
nlohmann::json parse_json_line(std::string_view line);

/// The member of an object as text, as in a field of a CSV file. Empty if the member is null or missing. Throws
/// DataError if the member is neither a number nor a text.
std::string json_field(const nlohmann::json& object, const std::string& name);

}  // namespace modebank::app
