#pragma once

#include <string>
#include <vector>

#include "app/text/warnings.hpp"
#include "io/archive/archive.hpp"

/// Windows and the features that are clustered, in words.
namespace modebank::app {

/// The summary's lines on windows: how many, how they ended, the global model, and the batch solver's audit.
/// `labels`: of the parameters.
std::string windows_text(const WindowFits& common, const WindowCounts& counts, const std::vector<std::string>& labels);

/// parameter_labels of the archive's windows; empty without windows.
std::vector<std::string> window_labels(const Archive& archive);
/// The features' names with labels in place of parameter names, those of one-lag fits included.
std::vector<std::string> feature_labels(const Archive& archive, std::vector<std::string> names);
/// " of one-lag fits of the same windows" where the mixture is over these, else nothing.
std::string features_origin(const Archive& archive);

}  // namespace modebank::app
