#pragma once

#include <string>
#include <vector>

#include "app/init/file_sets.hpp"
#include "app/init/survey.hpp"

namespace modebank::app {

/// All channels as a table for people. `surveyed`: the first file of each set.
std::string survey_text(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed);

}  // namespace modebank::app
