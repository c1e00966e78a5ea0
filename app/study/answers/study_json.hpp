#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace modebank::app {

/// Output of `study --json` for the folder of a study. It has the runs with varied values, status and scores, the
/// number of runs by status, and the best setting by each score. Parts that do not exist yet are missing.
nlohmann::json study_json(const std::filesystem::path& folder);

}  // namespace modebank::app
