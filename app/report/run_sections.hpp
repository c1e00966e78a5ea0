#pragma once

#include <nlohmann/json.hpp>

#include "app/config.hpp"
#include "app/report/page_arrays.hpp"
#include "io/archive.hpp"

/// The parts of a run's page, each null where the archive does not hold what it shows.
namespace modebank::app::report {

nlohmann::json origin_section(const Archive& archive);
nlohmann::json verdict_section(const Archive& archive);

}  // namespace modebank::app::report
