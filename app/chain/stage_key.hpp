#pragma once

#include <array>
#include <string>

#include "app/chain/stage_inputs.hpp"
#include "filter/learn/chain/stage.hpp"

namespace modebank {

/// For each stage a SHA-256 of everything that determines its numbers. These are all fields of its inputs, the keys of
/// earlier stages, the data's hash and modebank's version. Equal keys mean equal numbers. Different keys may also give
/// equal numbers.
using StageKeys = std::array<std::string, stage_count>;
StageKeys stage_keys(const ChainInputs& inputs, const std::string& data_hash);

}  // namespace modebank
