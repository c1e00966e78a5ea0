#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "filter/judge/free_run.hpp"

/// Output of `predict`. It omits samples without a prediction.
namespace modebank::app {

Index predicted_samples(const std::vector<FreeRun>& predicted);

/// One line per predicted sample. For each state, the columns are the prediction, its standard deviation and its band.
std::string predicted_csv(const Recording& recording, const std::vector<FreeRun>& predicted);

/// The same values for each run, as one array per column.
nlohmann::json predicted_json(const Recording& recording, const std::vector<FreeRun>& predicted);

}  // namespace modebank::app
