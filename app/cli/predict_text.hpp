#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "filter/judge/run/free_run.hpp"

/// Output of `predict`; samples without a prediction are left out.
namespace modebank::app {

Index predicted_samples(const std::vector<FreeRun>& predicted);

/// One line per predicted sample, with columns of the prediction, its standard deviation and its band per state.
std::string predicted_csv(const Recording& recording, const std::vector<FreeRun>& predicted);

/// The same per run, with one array per column.
nlohmann::json predicted_json(const Recording& recording, const std::vector<FreeRun>& predicted);

}  // namespace modebank::app
