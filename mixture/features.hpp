#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/local_model.hpp"

namespace modebank {

enum class FeatureSet { parameters, parameters_and_noise };

template <>
struct EnumNames<FeatureSet> {
  static constexpr Names<2> values{"parameters", "parameters+noise"};
};
enum class WindowChoice { automatic, full_rank, all };  ///< automatic: all with a prior, else full_rank

template <>
struct EnumNames<WindowChoice> {
  static constexpr Names<3> values{"automatic", "full_rank", "all"};
};

/// The cloud that is clustered: one point per clustered window.
struct FeatureCloud {
  std::vector<std::string> names;     ///< F: parameter names, then "log_noise_variance_<state>" when noise is included
  Eigen::MatrixXd points;             ///< F x N, physical units
  std::vector<Eigen::Index> windows;  ///< N, which window each point is
  std::vector<Eigen::Index> runs;     ///< N, run of that window
};

/// Failed fits and non-finite windows are left out.
FeatureCloud make_features(const WindowFits& fits, FeatureSet features, WindowChoice choice,
                           const std::vector<Channel>& states);

}  // namespace modebank
