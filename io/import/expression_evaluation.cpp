#include <algorithm>
#include <cmath>
#include <numbers>

#include "ident/base/not_a_number.hpp"
#include "io/import/expression.hpp"
#include "io/import/expression_program.hpp"

namespace modebank {

namespace {

double diff_per_second(double before, double after, double seconds) { return (after - before) / seconds; }

void differentiate(std::vector<double>& column, std::span<const double> time_s) {
  for (std::size_t k = column.size(); k-- > 1;)
    column[k] = diff_per_second(column[k - 1], column[k], time_s[k] - time_s[k - 1]);
  if (!column.empty()) column[0] = column.size() > 1 ? column[1] : not_a_number;
}

/// Computes slopes with `before` as the row before the first. Of several rows with equal times, only the first has a
/// slope. The next row's slope starts from that row.
void differentiate(std::vector<double>& column, std::span<const double> time_s, Expression::RowBefore& before) {
  for (std::size_t k = 0; k < column.size(); ++k) {
    const double seconds = time_s[k] - before.time_s;
    const Expression::RowBefore row{time_s[k], column[k]};
    column[k] = seconds > 0.0 ? diff_per_second(before.value, column[k], seconds) : not_a_number;
    if (seconds != 0.0) before = row;
  }
}

/// Turns are counted from the last row that has a value.
void unwrap(std::vector<double>& column, double& before) {
  constexpr double turn = 2.0 * std::numbers::pi;
  for (double& angle : column) {
    if (std::isnan(angle)) continue;
    if (!std::isnan(before)) angle = before + std::remainder(angle - before, turn);
    before = angle;
  }
}

bool any_missing(const std::vector<std::span<const double>>& columns, std::size_t row) {
  return std::any_of(columns.begin(), columns.end(), [row](const auto& column) { return std::isnan(column[row]); });
}

}  // namespace

std::vector<double> Expression::evaluate(const std::vector<std::span<const double>>& operands,
                                         std::span<const double> time_s, Memory* memory) const {
  const RowBefore none{not_a_number, not_a_number};
  if (memory != nullptr) memory->resize(steps_.size(), none);
  std::vector<std::vector<double>> computed;
  computed.reserve(steps_.size());
  for (const Step& step : steps_) {
    std::vector<std::span<const double>> columns;
    for (const std::size_t column : step.columns)
      columns.push_back(column < operands.size() ? operands[column] : computed[column - operands.size()]);
    Program program(step.program, columns.size());
    std::vector<double> result(time_s.size(), not_a_number);
    for (std::size_t row = 0; row < result.size(); ++row) {
      if (any_missing(columns, row)) continue;
      for (std::size_t i = 0; i < columns.size(); ++i) program.values()[i] = columns[i][row];
      result[row] = program();
    }
    RowBefore before = memory != nullptr ? (*memory)[computed.size()] : none;
    if (step.then == Step::Then::diff && memory != nullptr) differentiate(result, time_s, before);
    if (step.then == Step::Then::diff && memory == nullptr) differentiate(result, time_s);
    if (step.then == Step::Then::unwrap) unwrap(result, before.value);
    if (memory != nullptr) (*memory)[computed.size()] = before;
    for (double& value : result)
      if (!std::isfinite(value)) value = not_a_number;
    computed.push_back(std::move(result));
  }
  return std::move(computed.back());
}

}  // namespace modebank
