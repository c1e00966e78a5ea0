#pragma once

#include <string>
#include <vector>

#include "app/text/warnings.hpp"
#include "io/archive/archive.hpp"

/// Texts on windows and on the clustered features.
namespace modebank::app {

/// The summary's lines on windows: their number and status, and the global model. `labels`: parameters.
std::string windows_text(const WindowFits& common, const WindowCounts& counts, const std::vector<std::string>& labels);

/// What sensor noise does to the parameters of windows, where R exceeds a tenth of the most used mode's Q. Else empty.
std::string sensor_noise_words(const Archive& archive);

/// The parameter_labels of the archive's windows; empty if it has no windows.
std::vector<std::string> window_labels(const Archive& archive);
/// The names of the features. Parameters have their labels. Works for one-lag fits, too.
std::vector<std::string> feature_labels(const Archive& archive, std::vector<std::string> names);
/// The text " of one-lag fits of the same windows" if such fits are clustered, else empty.
std::string features_origin(const Archive& archive);

}  // namespace modebank::app
