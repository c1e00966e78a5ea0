#pragma once

#include <string>
#include <vector>

#include "app/init/guess.hpp"
#include "app/init/proposal.hpp"

namespace modebank::app {

/// Throws ConfigurationError where logs of different columns are not two instruments of the same runs: by their names,
/// or because the shorter of two single files lies by half outside the longer one's time.
void refuse_other_runs(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed, const Guess& guess);

/// A doubt that states how far two single files overlap in time, which are taken for one run's; else empty.
std::string doubt_of_one_run(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed,
                             const Guess& guess);

}  // namespace modebank::app
