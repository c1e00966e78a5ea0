#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/cli/check/check.hpp"
#include "app/config/config.hpp"

namespace modebank::app {

/// Reason why the data cannot be used as configured; empty if they can.
std::string unusable_text(const DataCheck& check);

/// Findings. Each names the key that accepts or corrects it.
std::vector<std::string> findings_of(const DataCheck& check, const Config& config);

std::string check_text(const DataCheck& check, const std::vector<std::string>& findings);
nlohmann::json check_json(const DataCheck& check, const std::vector<std::string>& findings);

}  // namespace modebank::app
