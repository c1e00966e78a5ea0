#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/init/proposal.hpp"
#include "app/init/survey.hpp"

namespace modebank::app {

/// Output of `init --json`: tables and channels of the files, the proposed keys with their reasons, and the doubts.
nlohmann::json init_json(const std::vector<SurveyedFile>& surveyed, const Proposal& proposal);

}  // namespace modebank::app
