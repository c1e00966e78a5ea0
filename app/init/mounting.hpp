#pragma once

#include <optional>
#include <vector>

#include "app/init/guess.hpp"
#include "app/init/words.hpp"

namespace modebank::app {

/// How the instrument is mounted whose rate about z is `z_rate`: empty where its table measures no acceleration, or
/// gravity lies along z pointing up.
std::optional<Mounting> find_mounting(const std::vector<SurveyedFile>& files, const ChannelPlace& z_rate);

/// Correlation of two channels of different tables over the time they share, at the slower one's samples and the lag,
/// of at most 2 s either way, at which it is largest; 0 where they share less than ten samples.
double correlation(const SurveyedTable& a, const Eigen::VectorXd& in_a, const SurveyedTable& b,
                   const Eigen::VectorXd& in_b);

}  // namespace modebank::app
