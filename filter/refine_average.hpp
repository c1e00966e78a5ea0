#pragma once

#include "filter/bank.hpp"
#include "filter/refine.hpp"
#include "filter/refine_validation.hpp"
#include "filter/training_transitions.hpp"
#include "ident/local_model.hpp"

namespace modebank {

/// What the fits to be averaged are made from. Keeps references.
struct AverageInput {
  const Recording& recording;
  const WindowFits& fits;
  const Bank& frame;
  const TrainingTransitions& transitions;
  const RefineOptions& options;
};

/// Expectation-maximisation ends in one of many optima that training runs hardly tell apart but new runs do. Instead of
/// one of them the bank becomes the union (united_bank.hpp) of the best 2..options.members starts' fits, if the runs
/// left out, scored by the fits that did not see them, gain more than least_likelihood_gain by it; of numbers that are
/// equal up to that the least. The members switch once in a run of mean length. For a state that is measured exactly;
/// each fit is screened, and has its standard errors, on its own. result.bank is the best start's fit, the first
/// member; the union replaces it, with a noise adaptation of its own, and the members are marked in the table.
void average_fits(const AverageInput& in, const CrossValidation& validation, Refinement& result);

}  // namespace modebank
