#pragma once

#include <vector>

#include "app/study/answers/answers.hpp"
#include "io/archive/study_file.hpp"

namespace modebank::app {

/// The answers as tables of /answers in study.h5: main_effects, influence and best. The column
/// `trial` contains the keys of trials.
std::vector<NamedTable> answer_tables(const StudyTable& table, const Answers& answers);

}  // namespace modebank::app
