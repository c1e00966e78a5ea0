#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/export/exported_bank.hpp"
#include "filter/step/bank_filter.hpp"
#include "ident/data/trajectory.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app::test {

/// A bank in the form of an archive's; channels without names get names.
ExportedBank as_exported(Bank bank, const FilterOptions& options = {});

/// A run with typical faults: signals missing singly and together, an unknown input, short gaps in time and one that is
/// too long.
Trajectory disturbed(Trajectory run, double dt_s);

/// Results of BankFilter::step for a run, sample by sample.
std::vector<FilterEstimate> stepped(const Bank& bank, const FilterOptions& options, const Trajectory& run);

/// The largest differences of the exported C from BankFilter over a run: of means in predicted standard deviations, of
/// probabilities, of covariances relative to the larger one, of log densities. The C is compiled by gcc and clang with
/// the strictest options of C99.
struct Differences {
  double mean = 0.0, probability = 0.0, covariance = 0.0, log_density = 0.0, ahead = 0.0;
  Index compared = 0;
  void join(const Differences& other);
};
Differences differences_of_c(const ExportedBank& bank, const std::vector<Trajectory>& runs);

}  // namespace modebank::app::test
