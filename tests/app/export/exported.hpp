#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/export/exported_bank.hpp"
#include "filter/step/bank_filter.hpp"
#include "ident/data/trajectory.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app::test {

/// A bank with everything that an export needs. Channels without names get names.
ExportedBank as_exported(Bank bank, const FilterOptions& options = {});

/// Adds typical faults to a run: one or several missing signals, an unknown input, short gaps in time and one long gap.
Trajectory disturbed(Trajectory run, double dt_s);

/// The largest differences between the exported C code and BankFilter over a run. Means are in units of the
/// predictions' standard deviations, probabilities are absolute, and covariances and log densities are relative. gcc
/// and clang compile the C code with the strictest options of C99.
struct Differences {
  double mean = 0.0, probability = 0.0, covariance = 0.0, log_density = 0.0, ahead = 0.0;
  Index compared = 0;
  void join(const Differences& other);
};
Differences differences_of_c(const ExportedBank& bank, const std::vector<Trajectory>& runs);

}  // namespace modebank::app::test
