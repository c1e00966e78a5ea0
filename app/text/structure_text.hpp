#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Whether the archive's data have inputs. True if the archive has no data.
inline bool acted_on(const Archive& archive) { return !archive.recording || !archive.recording->inputs.empty(); }

/// The row of the single linear models; null if there is none.
const StructureScore* of_linear(const FoundStructure& found);

/// Text such as "4 state lags, 1 input lag, delay 1 sample". Without inputs, it has only the state lags.
std::string structure_words(const FoundStructure& found, bool acted_on);

/// Text with the stages that use these lags, such as "bank, one_motion". The word "linear" in it stands for the
/// competitors with a single linear model.
std::string taken_by(const StructureScore& score);

/// One sentence for the first screen: the chosen structure and its scores on runs left out.
std::string structure_sentence(const FoundStructure& found, bool acted_on);

/// Section of `show` on the structure. It states how the structure was chosen, with one row for each structure of the
/// last comparison, and remarks.
std::string structure_text(const FoundStructure& found, bool acted_on, int width);

}  // namespace modebank::app
