#pragma once

#include <vector>

#include "app/init/guess.hpp"

namespace modebank::app {

/// Throws DataError if the states and inputs, or the rows of their table, do not belong together: one of many
/// recordings in a file, another robot's input, signals in one column, each signal with its own times, or vectors in
/// one cell. The message has the key that decides, or lines of Python that make a table.
void refuse_what_is_apart(const std::vector<SurveyedFile>& files, const Guess& guess);

}  // namespace modebank::app
