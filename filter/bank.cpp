#include "filter/bank.hpp"

#include <stdexcept>

namespace modebank {

namespace {

using Eigen::Index;

void expect_size(const std::string& what, Index rows, Index cols, Index expected_rows, Index expected_cols) {
  if (rows == expected_rows && cols == expected_cols) return;
  throw std::invalid_argument(what + " is " + std::to_string(rows) + " x " + std::to_string(cols) + ", must be " +
                              std::to_string(expected_rows) + " x " + std::to_string(expected_cols));
}

void check_mode(const Mode& mode, const LinearStructure& s, const std::string& name) {
  const Index n = s.dimension(), p = s.parameters();
  expect_size(name + " A", mode.model.A.rows(), mode.model.A.cols(), n, n);
  expect_size(name + " B", mode.model.B.rows(), mode.model.B.cols(), n, s.acting_inputs());
  expect_size(name + " c", mode.model.c.size(), 1, n, 1);
  expect_size(name + " Q", mode.Q.rows(), mode.Q.cols(), n, n);
  if (mode.spread.size() > 0) expect_size(name + " spread", mode.spread.rows(), mode.spread.cols(), p, p);
  if (mode.standard_error.size() > 0) expect_size(name + " standard error", mode.standard_error.size(), 1, p, 1);
}

}  // namespace

void check_sizes(const Bank& bank) {
  if (bank.structure.states < 1) throw std::invalid_argument("a bank needs at least one state");
  if (bank.modes.empty()) throw std::invalid_argument("a bank needs at least one mode");
  for (std::size_t j = 0; j < bank.modes.size(); ++j)
    check_mode(bank.modes[j], bank.structure, "mode " + std::to_string(j));
  const Index n_y = bank.C.rows(), K = bank.mode_count();
  if (n_y < 1) throw std::invalid_argument("C of the bank is empty");
  expect_size("C", n_y, bank.C.cols(), n_y, bank.structure.dimension());
  expect_size("R", bank.R.rows(), bank.R.cols(), n_y, n_y);
  expect_size("transition matrix", bank.transition.modes(), bank.transition.modes(), K, K);
  expect_size("initial probability", bank.initial_probability.size(), 1, K, 1);
}

}  // namespace modebank
