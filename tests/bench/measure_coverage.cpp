#include <fmt/format.h>

#include "tests/ident/fit/coverage_study.hpp"

/// Prints a table of docs/results/simulated.md: the share of windows whose 95 % region holds the true parameters.
int main() {
  using namespace modebank;
  constexpr std::ptrdiff_t windows = 20'000;  // the standard error of a share is then 0.15 %
  fmt::print(
      "| case | trivial, `model` | trivial, `sandwich` | Huber, `model` | Huber, `sandwich` "
      "|\n|---|---|---|---|---|\n");
  for (const CoverageCase which :
       {CoverageCase::gaussian, CoverageCase::outliers, CoverageCase::growing_noise, CoverageCase::poor}) {
    fmt::print("| {} |", name_of(which));
    for (const Loss loss : {Loss::trivial, Loss::huber})
      for (const CovarianceKind kind : {CovarianceKind::model, CovarianceKind::sandwich})
        fmt::print(" {:.1f} % |", 100.0 * test::measure_coverage(which, loss, kind, windows));
    fmt::print("\n");
  }
  return 0;
}
