#include "filter/step/feed/run_samples.hpp"

#include <stdexcept>
#include <string>

#include "modebank/base/error.hpp"

namespace modebank {

using Eigen::Index;

void check_run(const Bank& bank, const Trajectory& run) {
  check_sizes(bank);
  const auto mismatch = [&](const std::string& what, Index is, Index expected) {
    if (is != expected)
      throw std::invalid_argument("run " + run.run + " has " + std::to_string(is) + " " + what + ", the bank needs " +
                                  std::to_string(expected));
  };
  mismatch("measured signals", run.state.rows(), bank.C.rows());
  mismatch("inputs", run.input.rows(), bank.structure.inputs);
  mismatch("input samples", run.input.cols(), run.samples());
  if (run.time_s.size() > 0) mismatch("times", run.time_s.size(), run.samples());
  // one vectorised pass tests whether all entries are finite
  if ((run.input.leftCols(run.transitions()).array() * 0.0).sum() == 0.0) return;
  for (Index k = 0; k < run.transitions(); ++k)
    if (!run.input.col(k).allFinite())
      throw DataError("run " + run.run + ": the input of sample " + std::to_string(k) + " is not a finite number");
}

}  // namespace modebank
