#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/text/screen_facts.hpp"

namespace modebank::app {

/// Content of the first screen, as docs/reference/json.md describes it.
nlohmann::json summary_json(const Archive& archive, const Settings& settings);

}  // namespace modebank::app
