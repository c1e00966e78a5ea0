#pragma once

#include <iosfwd>

#include "app/init/guess.hpp"

namespace modebank::app {

/// Shows the guessed state and inputs, and reads other channels from `answers`: one line for the states and one for the
/// inputs. An empty line keeps the guess. Asks again if a channel does not exist or does not move. If the input ends,
/// the remaining guesses stay.
void confirm_roles(const std::vector<SurveyedFile>& files, Guess& guess, std::istream& answers,
                   std::ostream& questions);

}  // namespace modebank::app
