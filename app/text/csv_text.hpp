#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace modebank::app {

/// A table or array of an archive as CSV, from the JSON of `inspect`. Throws ConfigurationError for other objects.
/// `path`: the object's path, for error messages.
std::string csv_text(const nlohmann::json& object, const std::string& path);

}  // namespace modebank::app
