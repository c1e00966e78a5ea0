#include "io/import/value_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "ident/fit/scale.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Eigen::VectorXd;

std::string place(const FileStream& source, Index k) {
  return fmt::format("{}:{}", source.file, source.line[static_cast<std::size_t>(k)]);
}

void check_row(const RunStreams& run, const FileStream& source, const Eigen::Ref<const Eigen::RowVectorXd>& values,
               const std::string& name) {
  // Checks all rows in one vectorised pass. NaN is accepted, because comparisons with NaN are false.
  if (!(values.array().abs() >= largest_value).any()) return;
  for (Index k = 0; k < values.size(); ++k)
    if (std::abs(values(k)) >= largest_value)
      throw DataError(
          fmt::format("{}: column {}: {:g} cannot be used as a number, because its magnitude reaches {:g} (run "
                      "\"{}\"); leave the field empty where nothing was measured, and see data.missing",
                      place(source, k), name, values(k), largest_value, run.run));
}

/// A column and the values that it has in the runs of one role.
struct Column {
  Role role;
  bool of_states;
  Index row;
  std::string name;
};

/// Calls visit(run, source, k, value) for every value of a column, except where data.where is false.
template <class Visit>
void for_each_value(const std::vector<RunStreams>& runs, const Column& column, Visit visit) {
  for (const RunStreams& run : runs) {
    if (run.role != column.role) continue;
    const FileStream& source = column.of_states ? run.states : run.inputs;
    const Index N = source.stream.values.cols();
    const bool chosen = !run.where.empty() && run.where.front().values.size() == N;
    for (Index k = 0; k < N; ++k)
      if (const double value = source.stream.values(column.row, k);
          std::isfinite(value) && !(chosen && run.where.front().values(k) == 0.0))
        visit(run, source, k, value);
  }
}

/// The values of a column that are farthest from its median.
struct Furthest {
  double median = 0.0, largest = 0.0, held = 0.0;  ///< the share that these values have in the sum of squared distances
  std::ptrdiff_t count = 0;
};

/// The smallest set of values that make up more than half of the sum of squares and are far from all others. If this
/// set is not small, `count` is 0.
Furthest furthest_of(const VectorXd& values) {
  constexpr Index fewest = 50, one_in = 1000, few = 5, one_in_short = 25;
  constexpr double half = 0.5, beyond = 10.0;
  Furthest found;
  if (values.size() < fewest) return found;
  found.median = median(values);
  VectorXd distance = (values.array() - found.median).abs();
  const double squares = distance.squaredNorm();
  const Index most = std::max(values.size() / one_in, std::min(few, values.size() / one_in_short));
  std::partial_sort(distance.begin(), distance.begin() + most + 1, distance.end(), std::greater<>());
  double held = 0.0;
  for (Index count = 1; count <= most; ++count) {
    held += std::pow(distance(count - 1), 2);
    if (!(held > half * squares) || !(distance(count - 1) > beyond * distance(count))) continue;
    found.largest = distance(0);
    found.held = held / squares;
    found.count = count;
    break;
  }
  return found;
}

/// The remark on one column. Empty unless a few values dominate the column.
std::string dominating_in(const std::vector<RunStreams>& runs, const Column& column) {
  std::vector<double> all;
  for_each_value(runs, column,
                 [&](const RunStreams&, const FileStream&, Index, double value) { all.push_back(value); });
  const Furthest found = furthest_of(VectorXd::Map(all.data(), std::ssize(all)));
  if (found.count == 0) return {};
  const bool trains = column.role == Role::train;
  std::string line;
  for_each_value(runs, column, [&](const RunStreams& run, const FileStream& source, Index k, double value) {
    if (!line.empty() || std::abs(value - found.median) != found.largest) return;
    line = fmt::format(
        "{}: run \"{}\": {} = {:g}{} {:.4g} % of the variance of {} in the {} runs, so {}; if it is wrong, leave the "
        "field empty (data.missing) or the sample out (data.where)",
        place(source, k), run.run, column.name, value,
        found.count > 1 ? fmt::format(" and {} more hold", found.count - 1) : " holds", 100.0 * found.held, column.name,
        trains ? "training" : "held-out",
        trains ? "a least-squares model follows only this value" : "it dominates scores and errors");
  });
  return line;
}

}  // namespace

void check_values(const RunStreams& run, const DataOptions& options) {
  for (std::size_t i = 0; i < options.state.size(); ++i)
    check_row(run, run.states, run.states.stream.values.row(static_cast<Index>(i)), options.state[i]);
  for (std::size_t i = 0; i < options.input.size(); ++i)
    check_row(run, run.inputs, run.inputs.stream.values.row(static_cast<Index>(i)), options.input[i]);
  for (std::size_t i = 0; i < run.truth.size(); ++i)
    check_row(run, run.truth[i].with_states ? run.states : run.inputs, run.truth[i].values.transpose(),
              options.truth[i]);
}

std::vector<std::string> columns_without_value(const RunStreams& run, const DataOptions& options) {
  std::vector<std::string> lines;
  const auto look = [&](const std::vector<std::string>& names, const FileStream& source, bool needed) {
    if (source.stream.values.cols() == 0) return;  // other code reports that there are too few samples
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (source.stream.values.row(static_cast<Index>(i)).array().isFinite().any()) continue;
      lines.push_back(fmt::format("{}: run \"{}\": column {} has no value in any of its {} samples", source.file,
                                  run.run, names[i], source.stream.values.cols()));
      if (needed || options.missing != Missing::predict) throw DataError(lines.back());
    }
  };
  look(options.state, run.states, false);
  look(options.input, run.inputs, true);
  return lines;
}

std::vector<std::string> dominating_values(const std::vector<RunStreams>& runs, const DataOptions& options) {
  std::vector<std::string> lines;
  const auto look = [&](const std::vector<std::string>& names, bool of_states) {
    for (std::size_t i = 0; i < names.size(); ++i)
      for (const Role role : {Role::train, Role::test})
        if (std::string line = dominating_in(runs, {role, of_states, static_cast<Index>(i), names[i]}); !line.empty())
          lines.push_back(std::move(line));
  };
  look(options.state, true);
  look(options.input, false);
  return lines;
}

}  // namespace modebank
