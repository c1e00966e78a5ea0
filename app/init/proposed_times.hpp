#pragma once

#include "app/init/proposal.hpp"

namespace modebank::app {

/// Adds the [data] keys for the times of states and inputs, and doubts about the stamps' format.
void propose_times(const SurveyedTable& states, const SurveyedTable& inputs, Proposal& proposal);

}  // namespace modebank::app
