#pragma once

#include <string>

#include "app/study/answers/answers.hpp"

namespace modebank::app {

/// "mixture.components = 3, mixture.covariance = full" of a row.
std::string setting_text(const StudyTable& table, std::size_t row);

/// The answers as people read them: compact tables about the bank's scores in the headline's role. All others are in
/// study.h5.
std::string answers_text(const StudyTable& table, const Answers& answers);

}  // namespace modebank::app
