#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/study/answers/answers.hpp"
#include "io/archive/study_file.hpp"

namespace modebank::app {

/// The answers as tables of /answers in study.h5: main_effects, influence, best, pareto and, with repeats, spread.
/// Column `trial` is the key of a trial.
std::vector<NamedTable> answer_tables(const StudyTable& table, const Answers& answers);

}  // namespace modebank::app
