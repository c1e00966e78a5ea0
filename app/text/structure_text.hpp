#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Whether the archive's data have inputs; true if it has no data.
inline bool acted_on(const Archive& archive) { return !archive.recording || !archive.recording->inputs.empty(); }

/// "4 state lags, 1 input lag, delay 1 sample"; without inputs only the state lags.
std::string structure_words(const FoundStructure& found, bool acted_on);

/// The stages that use these lags: "bank, one_motion". linear: the competitors with a single linear motion.
std::string taken_by(const StructureScore& score);

/// One sentence for the first screen: the chosen structure, its scores on runs left out, and feedback.
std::string structure_sentence(const FoundStructure& found, bool acted_on);

/// The section of `show`: how the structure was chosen, one row for each structure of the last comparison, remarks.
std::string structure_text(const FoundStructure& found, bool acted_on, int width);

}  // namespace modebank::app
