#pragma once

#include <cstddef>

#include "modebank/base/names.hpp"
#include "modebank/ident/options.hpp"

namespace modebank {

/// Windows of L = 25 transitions with one state and two inputs. Each window is a separate run, so windows are
/// independent.
enum class CoverageCase {
  gaussian,       ///< white inputs, Gaussian noise of sd 0.1
  outliers,       ///< 5 % of the noise terms are ten times as large
  growing_noise,  ///< noise with standard deviation 0.02 + 0.3 |x|
  poor  ///< theta drawn from the prior and fitted with it; every other window has one command (rank 2 of 3), in the
        ///< others it varies by 2 % (nearly rank 2)
};

template <>
struct EnumNames<CoverageCase> {
  static constexpr Names<4> values{"gaussian", "outliers", "growing_noise", "poor"};
};

namespace test {

/// Share of windows whose 95 % region (confidence_region) contains the true theta. sigma is estimated from each window.
double measure_coverage(CoverageCase which, Loss loss, CovarianceKind kind, std::ptrdiff_t windows);

}  // namespace test
}  // namespace modebank
