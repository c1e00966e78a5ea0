#pragma once

#include <optional>
#include <vector>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Several banks of the same structure and sensor as one: all their modes, each bank switching among its own as before
/// and, with probability `switching` at each step, to any of the banks, there to a mode by its long-run share. The
/// filter of it averages the banks' predictions, each weighted by how well it predicted so far: dynamic model averaging
/// (Raftery, Karny & Ettler 2010, Technometrics 52(1), section 2; without switching Bayesian model averaging, Hoeting,
/// Madigan, Raftery & Volinsky 1999). The banks are equally probable at first; modes' weights are divided by their
/// number; what is not of the modes is the first bank's. Throws std::invalid_argument without a bank.
Bank unite(const std::vector<Bank>& members, double switching);

/// The union of several fits, and which rows of the table they are.
struct AveragedBank {
  Averaging averaging;
  std::optional<Bank> bank;  ///< empty where one fit is as good
  std::vector<std::size_t> rows;
  std::vector<Bank> of_splits = {};
};

/// Expectation-maximisation ends in one of many optima that training runs hardly tell apart but new runs do. Instead of
/// one of them the bank becomes the union of the best 2..options.members starts' fits, if the runs left out, scored by
/// the fits that did not see them, gain more than least_gain by it; of numbers that are equal up to that the least. The
/// members switch once in a run of mean length. For a state that is measured exactly; each fit is screened, and has its
/// standard errors, on its own. `one_fit`: the chosen fit as a bank, a member where it is among the best. The union has
/// a noise adaptation of its own.
AveragedBank average_fits(const RefineInput& in, const CrossValidation& validation, const Bank& one_fit);

}  // namespace modebank
