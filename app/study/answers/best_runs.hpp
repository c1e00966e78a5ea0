#pragma once

#include <filesystem>
#include <string>

#include "app/study/answers/answers.hpp"
#include "app/study/space/study_plan.hpp"

namespace modebank::app {

/// Configuration of the best setting by one score, ready for `modebank run`, with a comment that explains it.
std::string best_run_text(const Config& study, const StudyTable& table, const BestSetting& best);

/// Writes study.best.ini, the setting that is best by the headline, into the study's folder.
void write_best_run(const std::filesystem::path& folder, const Config& study, const StudyTable& table,
                    const Answers& answers);

}  // namespace modebank::app
