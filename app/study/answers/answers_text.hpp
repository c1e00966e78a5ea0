#pragma once

#include <string>

#include "app/study/answers/answers.hpp"

namespace modebank::app {

/// The setting of a row, such as "mixture.components = 3, mixture.covariance = full".
std::string setting_text(const StudyTable& table, std::size_t row);

/// The answers as text. It has short tables of the bank's scores in the role of the headline. study.h5 has all scores.
std::string answers_text(const StudyTable& table, const Answers& answers);

}  // namespace modebank::app
