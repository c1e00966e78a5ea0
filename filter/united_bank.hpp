#pragma once

#include <vector>

#include "filter/bank.hpp"

namespace modebank {

/// Several banks of the same structure and sensor as one: all their modes, each bank switching among its own as before
/// and, with probability `switching` at each step, to any of the banks, there to a mode by its long-run share. The
/// filter of it averages the banks' predictions, each weighted by how well it predicted so far: dynamic model averaging
/// (Raftery, Karny & Ettler 2010, Technometrics 52(1), section 2; without switching Bayesian model averaging, Hoeting,
/// Madigan, Raftery & Volinsky 1999). The banks are equally probable at first; modes' weights are divided by their
/// number; what is not of the modes is the first bank's. Throws std::invalid_argument without a bank.
Bank unite(const std::vector<Bank>& members, double switching);

}  // namespace modebank
