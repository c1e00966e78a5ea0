#pragma once

#include "app/init/file_sets.hpp"
#include "app/init/survey.hpp"

namespace modebank::app {

/// Survey of all files of a set. The values come from the first file; ranges and missing values come from all files.
/// Channels and tables that some file lacks are removed and named in `notes`. Throws the exceptions of survey_file.
SurveyedFile survey_set(const FileSet& set);

}  // namespace modebank::app
