#pragma once

#include <iosfwd>

#include "app/init/guess.hpp"

namespace modebank::app {

/// Shows the guessed state and inputs and reads others in their place: one line of channels each, where an empty line
/// keeps the guess. Asks again for a channel that does not exist or does not move. End of input keeps the rest.
void confirm_roles(const std::vector<SurveyedFile>& files, Guess& guess, std::istream& answers,
                   std::ostream& questions);

}  // namespace modebank::app
