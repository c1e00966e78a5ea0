#pragma once

#include <iosfwd>

#include "app/init/guess.hpp"

namespace modebank::app {

/// Shows the guessed state and inputs and takes others in their place: a line of channels each, an empty one keeps
/// them. Asks again for a channel that there is not, or that stands still; ends of input keep what is left.
void confirm_roles(const std::vector<SurveyedFile>& files, Guess& guess, std::istream& answers,
                   std::ostream& questions);

}  // namespace modebank::app
