#pragma once

#include <Eigen/Core>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// How far learning looks, and what it counts there.
struct LookAhead {
  Eigen::Index samples = 1;         ///< h: predictions 1, 2, ... h samples ahead
  Eigen::VectorXd error_unit = {};  ///< n_y, positive: minus half the squares of errors in this unit; empty: densities

  bool counts_errors() const { return error_unit.size() > 0; }
  bool is_likelihood() const { return samples == 1 && !counts_errors(); }
};

/// What learning that looks ahead counts: of every sample the mean of its log predictive densities 1, 2, ... h samples
/// ahead [nats], a composite likelihood (Varin, Reid & Firth 2011, Statistica Sinica 21(1)); N, NaN where a filter
/// scores nothing. Or of minus half the squared errors of the predicted means, in given units: what simulation error
/// methods minimise (Farina & Piroddi 2010, International Journal of Control 83(7)); 0 where there are none.
/// A sample has fewer predictions near a run's start: what is missing counts as nothing. Neighbouring
/// origins say nearly the same, so that beyond one sample ahead every look_ahead_stride(h)-th is taken, for all of
/// them, and for errors one sample ahead, too: from where the filter starts on, as a free run does. Of densities h = 1
/// is log_densities. Conditions of evaluate_run; h at least 1, else std::invalid_argument.
Eigen::VectorXd look_ahead_scores(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                  const LookAhead& look);

/// Their sum over a run; of densities one sample ahead log_likelihood, bit for bit.
double look_ahead_score(const Bank& bank, const Trajectory& run, const FilterOptions& options, const LookAhead& look);

/// Samples from one origin to the next: a quarter of the farthest horizon, rounded up.
inline Eigen::Index look_ahead_stride(Eigen::Index h) { return (h + 3) / 4; }

}  // namespace modebank
