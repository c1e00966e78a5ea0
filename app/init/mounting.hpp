#pragma once

#include <optional>
#include <vector>

#include "app/init/guess.hpp"
#include "app/init/words.hpp"

namespace modebank::app {

/// Mounting of the instrument that measures `z_rate`, its rate about z. Empty if its table has no acceleration, or if
/// gravity acts along z.
std::optional<Mounting> find_mounting(const std::vector<SurveyedFile>& files, const ChannelPlace& z_rate);

/// Largest correlation of two channels from different tables, over lags from -2 s to 2 s. It uses the samples of the
/// slower channel. 0 if the channels share fewer than ten samples.
double correlation(const SurveyedTable& a, const Eigen::VectorXd& in_a, const SurveyedTable& b,
                   const Eigen::VectorXd& in_b);

}  // namespace modebank::app
