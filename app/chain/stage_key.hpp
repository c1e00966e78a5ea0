#pragma once

#include <array>
#include <string>

#include "app/config/chain_options.hpp"
#include "filter/learn/chain/inputs.hpp"

/// Inputs of the stages other than learning, and the keys of all stages. The stages of learning have their inputs in
/// filter/learn/chain/inputs.hpp.
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

/// For each stage a SHA-256 of everything that determines its numbers. These are all fields of its inputs, the keys of
/// earlier stages, the data's hash and modebank's version. Equal keys mean equal numbers. Different keys may also give
/// equal numbers.
using StageKeys = std::array<std::string, stage_count>;
StageKeys stage_keys(const ChainInputs& inputs, const std::string& data_hash);

}  // namespace modebank
