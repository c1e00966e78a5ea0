#pragma once

#include <optional>
#include <vector>

#include "app/init/guess.hpp"
#include "app/init/words.hpp"

namespace modebank::app {

/// Mounting of the instrument whose rate about z is `z_rate`. Empty if its table has no acceleration, or if gravity
/// acts along z.
std::optional<Mounting> find_mounting(const std::vector<SurveyedFile>& files, const ChannelPlace& z_rate);

/// Largest correlation of two channels from different tables over lags of at most 2 s either way, at the samples of the
/// slower one. 0 if they share fewer than ten samples.
double correlation(const SurveyedTable& a, const Eigen::VectorXd& in_a, const SurveyedTable& b,
                   const Eigen::VectorXd& in_b);

}  // namespace modebank::app
