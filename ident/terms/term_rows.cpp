#include "ident/terms/term_rows.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "ident/base/clustered_error.hpp"
#include "ident/lag/lagged_rows.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index rows_together = 500;  // number of rows that are kept or dropped together

struct RunRegression {
  MatrixXd X, Y;
};

RunRegression rows_of(const Trajectory& run, const LinearStructure& widest, Index stride) {
  std::vector<Transitions> blocks;
  std::vector<std::vector<Index>> kept;
  Index count = 0;
  for (Index start = 0; start < run.transitions(); start += rows_together * stride) {
    blocks.push_back(stack_transitions(run, start, std::min(rows_together, run.transitions() - start), widest));
    kept.push_back(usable_rows(blocks.back()));
    count += std::ssize(kept.back());
  }
  RunRegression rows{MatrixXd(count, widest.regressors()), MatrixXd(count, widest.states)};
  Index first = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Index rows_of_block = std::ssize(kept[b]);
    rows.X.middleRows(first, rows_of_block) = blocks[b].regressors(kept[b], Eigen::all);
    rows.Y.middleRows(first, rows_of_block) = blocks[b].increments(kept[b], Eigen::all);
    first += rows_of_block;
  }
  return rows;
}

/// Cuts the parts into stretches if there are few parts.
void cut_few_parts(TermRows& rows) {
  StretchParts cut = stretch_parts(rows.part, rows.parts);
  rows.part = std::move(cut.part);
  rows.parts = cut.count;
}

}  // namespace

MatrixXd TermRows::regressors(const LinearStructure& s) const {
  std::vector<Index> columns(static_cast<std::size_t>(s.regressors()));
  const auto inputs_from = columns.begin() + s.dimension();
  std::iota(columns.begin(), inputs_from, Index{0});
  std::iota(inputs_from, inputs_from + s.acting_inputs(), widest.dimension());
  if (s.intercept) columns.back() = X.cols() - 1;
  return X(Eigen::all, columns);
}

TermRows TermRows::some(const std::vector<bool>& of_part) const {
  std::vector<Index> kept, position(of_part.size(), 0);
  TermRows result;
  result.widest = widest;
  for (std::size_t p = 0; p < of_part.size(); ++p)
    if (of_part[p]) position[p] = result.parts++;
  for (Index k = 0; k < count(); ++k) {
    const auto p = static_cast<std::size_t>(part[static_cast<std::size_t>(k)]);
    if (!of_part[p]) continue;
    kept.push_back(k);
    result.part.push_back(position[p]);
  }
  result.X = X(kept, Eigen::all);
  result.Y = Y(kept, Eigen::all);
  cut_few_parts(result);
  return result;
}

TermRows gather_term_rows(const Recording& recording, const LinearStructure& widest, Index most_rows) {
  const Index stride = 1 + recording.transitions(Role::train) / most_rows;
  std::vector<RunRegression> runs;
  Index count = 0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    RunRegression rows = rows_of(run, widest, stride);
    if (rows.X.rows() == 0) continue;
    count += rows.X.rows();
    runs.push_back(std::move(rows));
  }
  const Index run_count = std::ssize(runs);
  TermRows all{widest, MatrixXd(count, widest.regressors()), MatrixXd(count, widest.states), {}, run_count};
  Index first = 0;
  for (Index r = 0; r < run_count; ++r) {
    const RunRegression& rows = runs[static_cast<std::size_t>(r)];
    const Index length = rows.X.rows();
    all.X.middleRows(first, length) = rows.X;
    all.Y.middleRows(first, length) = rows.Y;
    all.part.insert(all.part.end(), static_cast<std::size_t>(length), r);
    first += length;
  }
  cut_few_parts(all);
  return all;
}

PartGain gain_over_parts(const VectorXd& difference, const TermRows& rows) {
  VectorXd sum = VectorXd::Zero(rows.parts), count = sum;
  for (Index k = 0; k < difference.size(); ++k) {
    const Index p = rows.part[static_cast<std::size_t>(k)];
    sum(p) += difference(k);
    count(p) += 1.0;
  }
  std::vector<Index> there;
  for (Index p = 0; p < rows.parts; ++p)
    if (count(p) > 0.0) there.push_back(p);
  if (there.size() < 2) return {difference.mean(), std::numeric_limits<double>::infinity()};
  return {difference.mean(), clustered_error(sum(there), count(there))};
}

}  // namespace modebank
