#pragma once

#include <string>

#include "app/config/chain_options.hpp"
#include "filter/learn/chain/inputs.hpp"

/// The options that each stage around learning gets (those of learning: filter/learn/chain/inputs.hpp).
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

/// Of a whole chain.
struct ChainInputs : LearningInputs {
  DataInputs data;
  CompetitorScoreInputs competitor_scores;
  BankScoreInputs bank_scores;
};

/// What is found out about filters, with the chain's seed where something is drawn.
ScoringOptions scoring_inputs(const ChainOptions& options);

/// Parts the options into what each stage needs.
ChainInputs chain_inputs(const ChainOptions& options);
/// With the inputs of learning that are given.
ChainInputs chain_inputs(const ChainOptions& options, LearningInputs learning);

}  // namespace modebank
