#pragma once

#include <string>

#include "app/config/chain_options.hpp"
#include "filter/learn/chain/inputs.hpp"

/// Options of the stages other than learning. The stages of learning have theirs in filter/learn/chain/inputs.hpp.
namespace modebank {

struct DataInputs {
  DataOptions data;
};

struct CompetitorScoreInputs {
  FitOptions window;
  ScoringOptions scoring;
};

struct BankScoreInputs {
  FilterOptions filter;
  ScoringOptions scoring;
};

/// Inputs of a whole chain.
struct ChainInputs : LearningInputs {
  DataInputs data;
  CompetitorScoreInputs competitor_scores;
  BankScoreInputs bank_scores;
};

/// Options of scoring. If scoring draws random numbers, its seed is the chain's.
ScoringOptions scoring_inputs(const ChainOptions& options);

/// Splits the options into the inputs of each stage.
ChainInputs chain_inputs(const ChainOptions& options);
/// Same as above, for given inputs of learning.
ChainInputs chain_inputs(const ChainOptions& options, LearningInputs learning);

}  // namespace modebank
