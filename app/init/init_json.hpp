#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/init/proposal.hpp"
#include "app/init/survey.hpp"

namespace modebank::app {

/// What `init --json` says: tables and channels of the files, the keys proposed, each with its reason, and doubts.
nlohmann::json init_json(const std::vector<SurveyedFile>& surveyed, const Proposal& proposal);

}  // namespace modebank::app
