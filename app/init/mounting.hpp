#pragma once

#include <optional>
#include <vector>

#include "app/init/guess.hpp"
#include "app/init/words.hpp"

namespace modebank::app {

/// Mounting of the instrument that measures `z_rate`, its rate about z. Empty if its table has no acceleration, or if
/// gravity acts along z.
std::optional<Mounting> find_mounting(const std::vector<SurveyedFile>& files, const ChannelPlace& z_rate);

}  // namespace modebank::app
