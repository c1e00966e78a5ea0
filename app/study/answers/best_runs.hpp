#pragma once

#include <filesystem>

#include "app/study/answers/answers.hpp"
#include "app/study/space/study_plan.hpp"

namespace modebank::app {

/// Writes study.best.ini, the setting that is best by the headline, into the study's folder.
void write_best_run(const std::filesystem::path& folder, const Config& study, const StudyTable& table,
                    const Answers& answers);

}  // namespace modebank::app
