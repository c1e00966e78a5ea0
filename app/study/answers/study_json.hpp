#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace modebank::app {

/// What `study --json` says of a study's folder: its runs with varied values, status and scores, how many of each
/// status there are, and the best setting by each score. Empty of what is not there yet.
nlohmann::json study_json(const std::filesystem::path& folder);

}  // namespace modebank::app
