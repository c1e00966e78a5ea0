#pragma once

#include <vector>

#include "filter/bank.hpp"
#include "filter/switching_regression.hpp"

namespace modebank {

/// Takes out one mode that cannot serve, worst reason first, and lists it: "starved" (fewer effective transitions than
/// regressors + 1), "unstable" (spectral radius of I + A above 1, the largest first), or "duplicate" of another:
/// pooling both modes' transitions (the moment-preserving merge of Runnalls 2007, IEEE Trans. AES 43(3), its bound on
/// the loss being the increase of 1/2 sum W log det Q) costs less than a likelihood-ratio test at 5 % would notice. A
/// duplicate's part in T goes to its twin. Returns whether there was one; the last mode stays whatever it is.
bool screen_worst_mode(const LinearStructure& structure, const TrainingTransitions& transitions,
                       const ModePosterior& posterior, SharedParts shared, SwitchingRegression& model,
                       std::vector<ScreenedMode>& screened);

}  // namespace modebank
