#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "modebank/mixture/options.hpp"

namespace modebank {

/// Whether a candidate could be fitted. too_few_points: there are fewer distinct points than components. failed: the
/// numbers exceeded double precision.
enum class CandidateStatus { fitted, too_few_points, failed };

template <>
struct EnumNames<CandidateStatus> {
  static constexpr Names<3> values{"fitted", "too_few_points", "failed"};
};

/// One candidate number of components with its criteria. Lower criteria are better (the opposite of mclust). A
/// candidate that was not fitted has log-likelihood minus infinity and criteria plus infinity.
struct Candidate {
  std::ptrdiff_t components = 0;                     ///< K, number of components
  CovarianceType covariance = CovarianceType::full;  ///< shape of the components' covariances
  double log_likelihood = 0.0;                       ///< [nats], of the features in their physical units, before
                                                     ///< scaling
  std::ptrdiff_t parameters = 0;                     ///< q, number of free parameters
  double effective_samples = 0.0;                    ///< N_eff
  double bic = 0.0;                                  ///< BIC (Schwarz 1978), with N_eff
  double aic = 0.0;                                  ///< Akaike 1974
  int iterations = 0;                                ///< iterations of the restart that was kept
  bool converged = false;                            ///< whether EM converged within the iteration limit
  int agreeing_restarts = 0;  ///< number of restarts that reached the best likelihood by themselves, without crossing
  bool selected = false;      ///< whether this candidate is the chosen one
  double bic_naive = std::numeric_limits<double>::quiet_NaN();  ///< BIC computed as if the points were independent
  int restarts = 0;                                             ///< number of independent random starts
  bool floor_active = false;  ///< whether the covariance floor acts on any component: a cluster without extent
  CandidateStatus status = CandidateStatus::fitted;  ///< whether the candidate could be fitted
  std::string failed;  ///< reason why the candidate could not be fitted; empty without a failure
};

}  // namespace modebank
