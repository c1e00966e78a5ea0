#pragma once

#include <string>

#include "app/config.hpp"
#include "ident/enum_names.hpp"

namespace modebank::app {

/// The parts of a run that trials can share.
enum class TrialStage { data, windows, competitors, mixture, bank, competitor_scores, bank_scores };
inline constexpr std::size_t trial_stage_count = 7;

/// Everything that decides the numbers of a stage, as text: the keys that it and the stages before it read, and the
/// data's hash. Equal texts mean equal numbers. It follows from the sections of the option table; what a stage reads
/// beyond its own section is said in stage_inputs.cpp.
std::string stage_inputs(TrialStage stage, const Config& config, const std::string& data_hash);

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::TrialStage> {
  static constexpr Names<modebank::app::trial_stage_count> values{"data", "windows",           "competitors", "mixture",
                                                                  "bank", "competitor_scores", "bank_scores"};
};
