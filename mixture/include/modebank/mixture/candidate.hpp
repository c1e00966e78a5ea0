#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "modebank/mixture/options.hpp"

namespace modebank {

/// Whether a candidate could be fitted: it has more components than there are distinct points (too_few_points), or its
/// fit met numbers it cannot handle (failed).
enum class CandidateStatus { fitted, too_few_points, failed };

template <>
struct EnumNames<CandidateStatus> {
  static constexpr Names<3> values{"fitted", "too_few_points", "failed"};
};

/// One candidate number of components, and what speaks for it. Criteria: lower is better (opposite of mclust), except
/// `heldout`. One that was not fitted has the likelihood minus infinity and the criteria plus infinity.
struct Candidate {
  std::ptrdiff_t components = 0;                     ///< K
  CovarianceType covariance = CovarianceType::full;  ///< of the components
  double log_likelihood = 0.0;                       ///< unscaled, physical units [nats]
  std::ptrdiff_t parameters = 0;                     ///< q, free ones
  double effective_samples = 0.0;                    ///< N_eff
  double bic = 0.0;                                  ///< Schwarz 1978, with N_eff
  double aic = 0.0;                                  ///< Akaike 1974
  double icl = 0.0;                                  ///< Biernacki, Celeux & Govaert 2000
  double heldout = 0.0;       ///< mean log density per point of runs left out; NaN unless asked for
  int iterations = 0;         ///< of the kept restart
  bool converged = false;     ///< within the limit of iterations
  int agreeing_restarts = 0;  ///< restarts that reached the best likelihood by themselves, before they were crossed
  bool selected = false;      ///< whether it is the chosen one
  double bic_naive = std::numeric_limits<double>::quiet_NaN();  ///< BIC as if the points were independent
  int restarts = 0;                                             ///< independent starts
  bool floor_active = false;  ///< whether the covariance floor holds any component: a cluster without extent
  CandidateStatus status = CandidateStatus::fitted;  ///< whether it could be fitted
  /// Standard error of the difference of `heldout` from the selected candidate's; NaN where there is none.
  double heldout_error = std::numeric_limits<double>::quiet_NaN();
  std::string failed;  ///< why it could not be fitted, or has no held-out score; empty: nothing failed
};

}  // namespace modebank
