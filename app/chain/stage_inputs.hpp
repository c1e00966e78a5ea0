#pragma once

#include <string>

#include "app/chain/options.hpp"
#include "filter/learn/chain/inputs.hpp"

/// The options that each stage around learning gets (those of learning: filter/learn/chain/inputs.hpp).
namespace modebank {

struct DataInputs {
  DataOptions data;
};

/// The archive whose mixture is a start; empty without one.
struct MixtureStartInputs {
  std::string file;
  std::string sha256;  ///< of its content
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
  MixtureStartInputs start;
  CompetitorScoreInputs competitor_scores;
  BankScoreInputs bank_scores;
};

/// What is found out about filters, with the chain's seed where something is drawn.
ScoringOptions scoring_inputs(const ChainOptions& options);

/// Parts the options into what each stage needs. Reads mixture_start, if there is one, for its hash: throws
/// ConfigurationError when it cannot be read.
ChainInputs chain_inputs(const ChainOptions& options);
/// With the inputs of learning that are given.
ChainInputs chain_inputs(const ChainOptions& options, LearningInputs learning);

}  // namespace modebank
