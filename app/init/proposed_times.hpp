#pragma once

#include "app/init/proposal.hpp"

namespace modebank::app {

/// Adds what [data] says of the times of states and inputs, and doubts about their form.
void propose_times(const SurveyedTable& states, const SurveyedTable& inputs, Proposal& proposal);

}  // namespace modebank::app
