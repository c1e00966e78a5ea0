#pragma once

#include <vector>

namespace modebank {

/// One-sided p value of Wilcoxon's signed-rank test (1945, Biometrics Bulletin 1(6)). If differences are symmetric
/// about zero, a rank sum is at least as large as here with this probability. Exact up to 50 differences, with shared
/// ranks for equal sizes. With more differences, the normal approximation is used. Zeros are ignored. 1 if all
/// differences are zero.
double signed_rank_p(const std::vector<double>& differences);

}  // namespace modebank
