#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "app/text/mode_families.hpp"
#include "io/archive/archive.hpp"

/// The families of a bank's modes for the page, and what it shows by family.
namespace modebank::app::report {

/// Per family its title, modes, use, stay, time constant and gains.
nlohmann::json families_of(const Archive& archive, const std::vector<ModeFamily>& families);

/// How many families stand one by one; the rest are others.
Index told_families(const std::vector<ModeFamily>& families);

/// Between the families that are told and all others as one, which come last.
nlohmann::json folded_transition_of(const Bank& bank, const std::vector<ModeFamily>& families);

/// Which families the bank took each label's samples for; null without labels.
nlohmann::json label_section(const Archive& archive, const std::vector<ModeFamily>& families);

}  // namespace modebank::app::report
