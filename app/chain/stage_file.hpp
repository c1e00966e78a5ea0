#pragma once

#include <string>
#include <string_view>

#include "app/chain/stage_key.hpp"

namespace modebank {

/// Name of a file that holds the result of one stage: STAGE-KEY.h5.
std::string stage_file_name(Stage stage, std::string_view key);

/// Whether stage_file_name makes such a name. No other file in a folder of stages is ours to remove.
bool is_stage_file_name(std::string_view name);

}  // namespace modebank
