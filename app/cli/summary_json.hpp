#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/text/screen_facts.hpp"

namespace modebank::app {

/// What the first screen says, as docs/reference/json.md has it.
nlohmann::json summary_json(const Archive& archive, const Settings& settings);

}  // namespace modebank::app
