#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Whether the archive's data have inputs, as far as it holds them.
inline bool acted_on(const Archive& archive) { return !archive.recording || !archive.recording->inputs.empty(); }

/// "4 state lags, 1 input lag, delay 1 sample"; without inputs the state lags alone.
std::string structure_words(const FoundStructure& found, bool acted_on);

/// The stages that take these lags: "bank, one_motion"; linear: the competitors that have one linear motion.
std::string taken_by(const StructureScore& score);

/// One sentence for the first screen: the chosen structure, its scores on runs left out, and feedback.
std::string structure_sentence(const FoundStructure& found, bool acted_on);

/// The part of `show`: how it was chosen, a row for each structure compared at the end, remarks.
std::string structure_text(const FoundStructure& found, bool acted_on, int width);

}  // namespace modebank::app
