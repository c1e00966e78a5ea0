#include "ident/lag/identifiable.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/stacked_triangle.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index most_lags = 20, most_rows = 50'000, block_rows = 1000, fewest_rows_per_column = 4;
constexpr double explained = 2.0;   // residual that rounding explains, in its standard deviations
constexpr double least_gain = 0.5;  // what others leave, as a share of what a column's own past leaves: more is chance
constexpr double least_effect = 0.1;  // of a joined column among 20 lags, as a share of the largest

/// Triangle of the rows [1, lags 0, 1, ... of column 0, ...]; a Gram matrix would lose half of the digits. In units of
/// the standard deviation of each column's rounding, a residual compares with the coefficients of its equation.
struct Rows {
  Index states, columns, lags;
  VectorXd unit;
  double count = 0.0;
  MatrixXd R = {};

  Index at(Index column, Index lag) const { return 1 + column * lags + lag; }
  auto centred(Index at) const { return R.col(at).tail(R.rows() - 1); }
  MatrixXd centred(std::vector<Index> by, Index target) const {
    by.push_back(target);
    return R.bottomRows(R.rows() - 1)(Eigen::all, by);
  }
  void add(const MatrixXd& values, Index every) {
    for (Index first = lags - 1; first < values.cols(); first += every * block_rows) {
      MatrixXd X = MatrixXd::Ones(std::min(block_rows, values.cols() - first), 1 + columns * lags);
      for (Index c = 0; c < columns; ++c)
        for (Index lag = 0; lag < lags; ++lag)
          X.col(at(c, lag)) = values.row(c).segment(first - lag, X.rows()).transpose() / unit(c);
      R = stacked_triangle(R, X);
      count += static_cast<double>(X.rows());
    }
  }
};

struct Equation {
  std::vector<Index> by;
  VectorXd b;
  double rounding, residual;  ///< standard deviation of what rounding makes, and residual in units of it
};

/// Least squares. The rounding of the regressors is the ridge, so what only rounding tells apart has small
/// coefficients.
Equation explain(const Rows& rows, Index target, std::vector<Index> by) {
  const Index p = std::ssize(by), known = rows.R.rows() - 1;
  MatrixXd X = MatrixXd::Zero(known + p, p + 1);
  X.topRows(known) = rows.centred(by, target);
  X.bottomLeftCorner(p, p).diagonal().setConstant(std::sqrt(rows.count));
  const MatrixXd R = qr_triangle(X);
  const VectorXd b = R.topLeftCorner(p, p).triangularView<Eigen::Upper>().solve(R.col(p).head(p));
  const double left = (X.col(p) - X.leftCols(p) * b).head(known).norm(), rounding = std::sqrt(1.0 + b.squaredNorm());
  return {std::move(by), b, rounding, left / std::sqrt(rows.count - static_cast<double>(p + 1)) / rounding};
}

/// By `own` lags of the column's past and `others` lags of each other column; a state by states alone.
Equation equation_of(const Rows& rows, Index column, Index own, Index others) {
  std::vector<Index> by;
  for (Index c = 0; c < (column < rows.states ? rows.states : rows.columns); ++c)
    for (Index lag = c == column ? 1 : 0; lag < (c == column ? own + 1 : others); ++lag) by.push_back(rows.at(c, lag));
  return explain(rows, rows.at(column, 0), std::move(by));
}

ColumnRelation in_units(const Rows& rows, Index column, const Equation& equation, bool complete) {
  ColumnRelation relation{column, {}, rows.R(0, rows.at(column, 0)), complete};
  std::vector<std::pair<double, ColumnRelation::Term>> terms;
  VectorXd effect = VectorXd::Zero(rows.columns);
  double slack = std::sqrt(rows.count);  // what rounding makes of the constant; it grows with means far from zero
  for (Index i = 0; i < equation.b.size(); ++i) {
    const Index at = equation.by[static_cast<std::size_t>(i)], c = (at - 1) / rows.lags;
    const double b = equation.b(i), size = rows.centred(at).norm();
    terms.push_back({std::abs(b) * size, {c, (at - 1) % rows.lags, b * rows.unit(column) / rows.unit(c)}});
    relation.constant -= b * rows.R(0, at);
    slack += std::abs(rows.R(0, at)) / std::max(size, 1e-300);
    if (c != column) effect(c) = std::max(effect(c), std::abs(b) * size);
  }
  if (std::abs(relation.constant) < 4.0 * equation.rounding * slack) relation.constant = 0.0;
  relation.constant *= rows.unit(column) / rows.R(0, 0);
  std::ranges::stable_sort(terms, std::greater(), [](const auto& term) { return term.first; });
  for (const auto& term : terms)
    if (complete || relation.terms.size() < 4) relation.terms.push_back(term.second);
  for (Index c = 0; c < rows.columns; ++c)
    if (effect(c) > (complete ? 0.0 : least_effect * effect.maxCoeff())) relation.joined.push_back(c);
  relation.follows_states = column >= rows.states && !relation.joined.empty() && relation.joined.back() < rows.states;
  return relation;
}

/// Looks for an equation of one column: of the same sample, of that and the previous one, of 20 lags.
void find(std::vector<ColumnRelation>& relations, const Rows& rows, Index column) {
  const Index lags = column < rows.states ? 1 : rows.lags;
  const double alone = equation_of(rows, column, 0, 0).residual, past = equation_of(rows, column, lags - 1, 0).residual;
  for (const Index others : {Index{1}, Index{2}, lags}) {
    const double limit = std::min(explained, least_gain * (others == 1 ? alone : past));
    if (others > lags || (others > 1 && past < explained)) return;
    Equation equation = equation_of(rows, column, others - 1, others);
    if (!(equation.residual < limit)) continue;
    for (std::size_t i = equation.by.size(); others < 3 && i-- > 0;) {  // without what is not needed, oldest first
      std::vector<Index> fewer = equation.by;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
      if (Equation without = explain(rows, rows.at(column, 0), fewer); without.residual < limit) equation = without;
    }
    if (others < 3) {  // total least squares, because rounding of the terms draws coefficients of least squares to zero
      const VectorXd v = thin_svd(rows.centred(equation.by, rows.at(column, 0))).V.rightCols(1);
      equation.b = -v.head(v.size() - 1) / v(v.size() - 1);
    }
    relations.push_back(in_units(rows, column, equation, others < 3));
    return;
  }
}

}  // namespace

VectorXd decimal_steps(const Recording& recording) {
  constexpr int most_decimals = 12;
  const Index n = recording.state_count();
  VectorXd steps = VectorXd::Zero(n + recording.input_count());
  for (Index c = 0; c < steps.size(); ++c) {
    int decimals = 0;
    for (const Trajectory& run : recording.runs)
      for (Index k = 0; k < run.samples() && run.role == Role::train && decimals <= most_decimals; ++k) {
        const double value = c < n ? run.states()(c, k) : run.inputs()(c - n, k);
        const auto fits = [&](double scaled) {
          return std::abs(scaled - std::round(scaled)) <= 1e-15 * std::abs(scaled) + 1e-9;
        };
        while (decimals <= most_decimals && std::isfinite(value) && !fits(value * std::pow(10.0, decimals))) ++decimals;
      }
    if (decimals <= most_decimals) steps(c) = std::pow(10.0, -decimals);
  }
  return steps;
}

Identifiability identifiable(const Recording& recording, const VectorXd& quanta) {
  const Index n = recording.state_count(), columns = n + recording.input_count();
  Index samples = 0;
  VectorXd low = VectorXd::Constant(columns, INFINITY), high = -low;
  std::vector<MatrixXd> runs;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train || run.samples() == 0) continue;
    runs.emplace_back(columns, run.samples()) << run.states(), run.inputs();
    samples += run.samples();
    low = low.cwiseMin(runs.back().rowwise().minCoeff());
    high = high.cwiseMax(runs.back().rowwise().maxCoeff());
  }
  if (samples == 0) return {};
  const VectorXd size = low.cwiseAbs().cwiseMax(high.cwiseAbs());
  Identifiability found;
  for (Index c = 0; c < columns; ++c)
    if (!(high(c) - low(c) > 1e-9 * size(c))) found.resting.push_back(c);
  Rows rows{n, columns, std::min(most_lags, samples / (fewest_rows_per_column * columns)),
            quanta.cwiseMax(1e-12 * size).cwiseMax(1e-300) / std::sqrt(12.0)};
  if (rows.lags < 2) return found;
  rows.R.resize(0, 1 + columns * rows.lags);
  for (const MatrixXd& run : runs) rows.add(run, 1 + samples / most_rows);
  if (rows.count < 2.0 * static_cast<double>(rows.R.cols())) return found;
  for (Index c = 0; c < columns; ++c)
    if (!std::ranges::count(found.resting, c)) find(found.relations, rows, c);
  return found;
}

}  // namespace modebank
