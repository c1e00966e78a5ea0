#pragma once

#include <vector>

namespace modebank {

/// One-sided p value of Wilcoxon's signed-rank test (1945, Biometrics Bulletin 1(6)). It is the probability of ranks
/// that are at least as positive as these if differences are symmetric about zero. Exact up to 50 differences, with
/// shared ranks for equal sizes; beyond that by the normal approximation. Zeros are ignored. 1 if all differences are
/// zero.
double signed_rank_p(const std::vector<double>& differences);

}  // namespace modebank
