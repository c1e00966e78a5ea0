#pragma once

#include <string>

#include "app/config/chain_options.hpp"
#include "filter/learn/chain/inputs.hpp"

/// Options of each stage around learning (for the stages of learning: filter/learn/chain/inputs.hpp).
namespace modebank {

struct DataInputs {
  DataOptions data;
};

struct CompetitorScoreInputs {
  FitOptions window;
  FilterOptions filter;
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

/// Options of scoring; the seed is the chain's where something is drawn.
ScoringOptions scoring_inputs(const ChainOptions& options);

/// Splits the options into the inputs of each stage.
ChainInputs chain_inputs(const ChainOptions& options);
/// The same, with the inputs of learning already given.
ChainInputs chain_inputs(const ChainOptions& options, LearningInputs learning);

}  // namespace modebank
