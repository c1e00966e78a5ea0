#pragma once

#include <string>
#include <vector>

#include "app/init/guess.hpp"
#include "app/init/proposal.hpp"

namespace modebank::app {

/// Times, states, inputs and runs that `run LOG` uses, and its doubts. These are labelled paragraphs as on the first
/// screen.
std::string taken_text(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed, const Guess& guess,
                       const Proposal& proposal);

/// A labelled paragraph, wrapped at the width of the terminal or of the first screen.
std::string paragraph(const std::string& label, const std::string& text);

}  // namespace modebank::app
