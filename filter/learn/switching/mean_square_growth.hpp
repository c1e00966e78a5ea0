#pragma once

#include "filter/learn/switching/switching_regression.hpp"

namespace modebank {

/// Growth per step of the second moment of x[k+1] = F_j x[k] under switching by T. It is the spectral radius of the
/// operator X_j -> sum_i T_ij F_i X_i F_i' (Costa, Fragoso & Marques 2005, "Discrete-Time Markov Jump Linear Systems",
/// chapter 3). Below 1 the system is mean-square stable. The accuracy is 1e-8. For a defective operator (double
/// integrators) it is about eps^(1 / order of the defect), with the machine precision eps. Infinite if a mode is not
/// finite.
double mean_square_growth(const LinearStructure& structure, const SwitchingRegression& model);

}  // namespace modebank
