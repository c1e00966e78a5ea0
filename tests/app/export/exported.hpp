#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/export/exported_bank.hpp"
#include "filter/step/bank_filter.hpp"
#include "ident/data/trajectory.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app::test {

/// A bank as if it came from an archive; channels without names get some.
ExportedBank as_exported(Bank bank, const FilterOptions& options = {});

/// A run with what a filter must live with: signals missing singly and together, an input that is not known, short gaps
/// in time and one that is too long.
Trajectory disturbed(Trajectory run, double dt_s);

/// What BankFilter::step says of a run, sample by sample.
std::vector<FilterEstimate> stepped(const Bank& bank, const FilterOptions& options, const Trajectory& run);

/// The largest differences of the exported C, compiled by gcc and by clang as strictly as C99 can be, from BankFilter
/// over a run: of means in predicted standard deviations, of probabilities, of covariances relative to the larger, of
/// log densities.
struct Differences {
  double mean = 0.0, probability = 0.0, covariance = 0.0, log_density = 0.0, ahead = 0.0;
  Index compared = 0;
  void join(const Differences& other);
};
Differences differences_of_c(const ExportedBank& bank, const std::vector<Trajectory>& runs);

}  // namespace modebank::app::test
