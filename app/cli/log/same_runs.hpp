#pragma once

#include <string>
#include <vector>

#include "app/init/guess.hpp"
#include "app/init/proposal.hpp"

namespace modebank::app {

/// Throws ConfigurationError for logs with different columns that do not belong to the same runs. This is the case if
/// their names do not match. For two single files it is also the case if more than half of the shorter one lies outside
/// the longer one's time.
void refuse_other_runs(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed, const Guess& guess);

/// A doubt that states the common time of two single files if both are used as one run; else empty.
std::string doubt_of_one_run(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed,
                             const Guess& guess);

}  // namespace modebank::app
