#pragma once

#include "filter/learn/switching/switching_regression.hpp"

namespace modebank {

/// Growth per step of the second moment of x[k+1] = F_j x[k] under switching by T: the spectral radius of the operator
/// X_j -> sum_i T_ij F_i X_i F_i' (Costa, Fragoso & Marques 2005, "Discrete-Time Markov Jump Linear Systems", chapter
/// 3). The system is mean-square stable below 1. To 1e-8; of a defective operator, as double integrators make one, to
/// about the root of its defect's order of the machine's precision. Infinite where a mode is not finite.
double mean_square_growth(const LinearStructure& structure, const SwitchingRegression& model);

}  // namespace modebank
