#pragma once

#include "app/init/file_sets.hpp"
#include "app/init/survey.hpp"

namespace modebank::app {

/// Survey of all files of a set together: values of the first, ranges and missing values over all. Channels and tables
/// that are not in every file are left out and named in `notes`. Throws as survey_file does.
SurveyedFile survey_set(const FileSet& set);

}  // namespace modebank::app
