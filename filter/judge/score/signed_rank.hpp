#pragma once

#include <vector>

namespace modebank {

/// Wilcoxon's signed-rank test (1945, Biometrics Bulletin 1(6)): the probability that differences as likely above zero
/// as below it, by the same amounts, have ranks as positive as these. Exact up to 50 differences, equal sizes sharing
/// their ranks; beyond by the normal approximation. Zeros are left out; 1 without any other.
double signed_rank_p(const std::vector<double>& differences);

}  // namespace modebank
