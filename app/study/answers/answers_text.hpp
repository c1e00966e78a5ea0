#pragma once

#include <string>

#include "app/study/answers/answers.hpp"

namespace modebank::app {

/// The setting of a row: "mixture.components = 3, mixture.covariance = full".
std::string setting_text(const StudyTable& table, std::size_t row);

/// The answers as text: compact tables of the bank's scores in the headline's role. study.h5 has all scores.
std::string answers_text(const StudyTable& table, const Answers& answers);

}  // namespace modebank::app
