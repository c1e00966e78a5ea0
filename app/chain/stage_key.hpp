#pragma once

#include <array>
#include <string>

#include "app/chain/stage_inputs.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// The stages of the chain, in their order.
enum class Stage { data, structure, windows, mixture, competitors, bank, competitor_scores, bank_scores };
inline constexpr std::size_t stage_count = 8;

template <>
struct EnumNames<Stage> {
  static constexpr Names<stage_count> values{"data",        "structure", "windows",           "mixture",
                                             "competitors", "bank",      "competitor_scores", "bank_scores"};
};

constexpr std::size_t index_of(Stage stage) { return static_cast<std::size_t>(stage); }

/// Of each stage the SHA-256 of everything that decides its numbers: its inputs struct field by field, the keys of the
/// stages whose results it starts from, the data's hash and modebank's version. Equal keys mean equal numbers; numbers
/// may be equal where keys are not.
using StageKeys = std::array<std::string, stage_count>;
StageKeys stage_keys(const ChainInputs& inputs, const std::string& data_hash);

}  // namespace modebank
