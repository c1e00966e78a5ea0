#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "app/text/mode_families.hpp"
#include "io/archive/archive.hpp"

/// The families of a bank's modes on the page, and the parts of the page that show families.
namespace modebank::app::report {

/// Title, modes, use, stay, time constant and gains of each family.
nlohmann::json families_of(const Archive& archive, const std::vector<ModeFamily>& families);

/// Number of families with a row of their own; all others share one row.
Index told_families(const std::vector<ModeFamily>& families);

/// Transition matrix between the families with a row of their own and all others, which form one last family.
nlohmann::json folded_transition_of(const Bank& bank, const std::vector<ModeFamily>& families);

/// For each label, the families to which the bank assigns its samples; null without labels.
nlohmann::json label_section(const Archive& archive, const std::vector<ModeFamily>& families);

}  // namespace modebank::app::report
