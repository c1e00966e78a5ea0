#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "app/text/mode_families.hpp"
#include "io/archive/archive.hpp"

/// Families of a bank's modes, and the parts of the page that show families.
namespace modebank::app::report {

/// For each family: title, modes, use, stay, time constant and gains.
nlohmann::json families_of(const Archive& archive, const std::vector<ModeFamily>& families, const std::string& unit);

/// Number of families that have their own row. All other families share one row.
Index told_families(const std::vector<ModeFamily>& families);

/// Transition matrix between the families that have their own row. All other families form one last family.
nlohmann::json folded_transition_of(const Bank& bank, const std::vector<ModeFamily>& families);

/// For each label, the families to which the bank assigns the samples with this label. Null without labels.
nlohmann::json label_section(const Archive& archive, const std::vector<ModeFamily>& families);

}  // namespace modebank::app::report
