#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace modebank::app {

/// Output of `study --json` for a study's folder: runs with varied values, status and scores, counts by status, and the
/// best setting by each score. Parts that do not exist yet are left out.
nlohmann::json study_json(const std::filesystem::path& folder);

}  // namespace modebank::app
