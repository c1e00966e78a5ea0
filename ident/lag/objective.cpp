#include "ident/lag/objective.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ident/base/linalg.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/fit/constants.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double least_unexplained = 1e-12;  // keeps logarithms finite for noise-free data

/// Times at steps of `period_s` between two given times, without gaps of the states at `time_s`.
VectorXd averaging_times(const VectorXd& time_s, double first_s, double last_s, double period_s) {
  const double longest = gap_periods * std::max(median_period_s(time_s), period_s);
  std::vector<double> times;
  Index j = 0;
  double t = first_s + 0.5 * period_s;
  while (t <= last_s - 0.49 * period_s) {
    while (j + 1 < time_s.size() && time_s(j + 1) <= t) ++j;
    const bool in_gap = j + 1 < time_s.size() && time_s(j + 1) - time_s(j) > longest;
    if (!in_gap) times.push_back(t);
    t += period_s;
  }
  return Eigen::Map<const VectorXd>(times.data(), static_cast<Index>(times.size()));
}

/// Subtracts the weighted means of the rows.
MatrixXd centred(const MatrixXd& values, const VectorXd& weights) {
  const VectorXd mean = values * weights / weights.sum();
  return values.colwise() - mean;
}

/// Minimum-norm weighted least-squares coefficients of Y = B X, n x m. Directions in which X hardly varies (relative
/// eigenvalue of its Gram matrix below 1e-10) get zero coefficients.
MatrixXd regress_rows(const MatrixXd& X, const MatrixXd& Y, const VectorXd& weights) {
  constexpr double collinear = 1e-10;
  const MatrixXd XW = X * weights.asDiagonal();
  const SymmetricEigen gram = symmetric_eigen(XW * X.transpose());
  const double floor = collinear * gram.values.maxCoeff();
  const VectorXd inverse = (gram.values.array() > floor).select(gram.values.cwiseInverse(), 0.0);
  return (Y * XW.transpose()) * gram.vectors * inverse.asDiagonal() * gram.vectors.transpose();
}

}  // namespace

Stream without_missing(const Stream& stream) {
  std::vector<Index> known;
  for (Index k = 0; k < stream.time_s.size(); ++k)
    if (stream.values.col(k).allFinite()) known.push_back(k);
  if (static_cast<Index>(known.size()) == stream.time_s.size()) return stream;
  return {stream.time_s(known), stream.values(Eigen::all, known)};
}

Stream with_last_known(const Stream& stream) {
  Index first = 0;
  while (first < stream.time_s.size() && !stream.values.col(first).allFinite()) ++first;
  const Index count = stream.time_s.size() - first;
  Stream known{stream.time_s.tail(count), stream.values.rightCols(count)};
  for (Index k = 1; k < count; ++k)
    known.values.col(k) = known.values.col(k).array().isFinite().select(known.values.col(k), known.values.col(k - 1));
  return known;
}

LagObjective::LagObjective(const Stream& states, const Stream& inputs, Index most_samples) : inputs_(inputs) {
  const double first = std::max(states.time_s(0), inputs.time_s(0));
  const double last = std::min(states.time_s(states.time_s.size() - 1), inputs.time_s(inputs.time_s.size() - 1));
  period_s_ = std::max({median_period_s(states.time_s), median_period_s(inputs.time_s),
                        (last - first) / static_cast<double>(most_samples)});
  centres_s_ = averaging_times(states.time_s, first, last, period_s_);
  states_ = AveragedStream::linear(states).mean(centres_s_, period_s_);
  weights_ = VectorXd::Ones(centres_s_.size());
}

const AveragedStream& LagObjective::response(double time_constant_s) const {
  if (time_constant_s != response_time_constant_s_) response_ = AveragedStream::held(inputs_, time_constant_s);
  response_time_constant_s_ = time_constant_s;
  return response_;
}

std::optional<LagObjective::Fit> LagObjective::fit(const LagPoint& point) const {
  const AveragedStream& input = response(point.time_constant_s);
  const VectorXd times = centres_s_.array() - point.lag_s;
  const double half = 0.5 * period_s_, slack = 1e-9 * period_s_;
  const double* const begin = times.data();
  const double* const from = std::lower_bound(begin, begin + times.size(), input.first_s() + half - slack);
  // The last sample of a held input is valid for one more sample period.
  const double* const to = std::upper_bound(from, begin + times.size(), input.last_s() + half + slack);
  Fit fit;
  fit.first = from - begin;
  fit.samples = to - from;
  if (fit.samples < std::max<Index>(8, times.size() / 2)) return std::nullopt;
  fit.weights = weights_.segment(fit.first, fit.samples);
  fit.inputs = centred(input.mean(times.segment(fit.first, fit.samples), period_s_), fit.weights);
  const MatrixXd Y = centred(states_.middleCols(fit.first, fit.samples), fit.weights);
  fit.coefficients = regress_rows(fit.inputs, Y, fit.weights);
  fit.residuals = Y - fit.coefficients * fit.inputs;
  fit.unexplained = VectorXd::Ones(Y.rows());
  for (Index i = 0; i < Y.rows(); ++i) {
    const double total = Y.row(i).array().square().matrix().dot(fit.weights);
    const double rest = fit.residuals.row(i).array().square().matrix().dot(fit.weights);
    if (total > 0.0) fit.unexplained(i) = std::max(rest / total, least_unexplained);
  }
  return fit;
}

double LagObjective::cost(const LagPoint& point) const {
  const std::optional<Fit> found = fit(point);
  return found ? found->unexplained.array().log().mean() : 0.0;
}

void LagObjective::reweight(const LagPoint& point) {
  const std::optional<Fit> found = fit(point);
  if (!found) return;
  weights_.setOnes();
  for (Index i = 0; i < states_.rows(); ++i) {
    const double bend = huber_tuning * normalised_mad(found->residuals.row(i).transpose());
    if (!(bend > 0.0)) continue;
    auto weights = weights_.segment(found->first, found->samples).array();
    weights = weights.min((bend / found->residuals.row(i).transpose().array().abs()).min(1.0));
  }
}

MatrixXd LagObjective::inputs_at(const LagPoint& point, const Fit& fit) const {
  const VectorXd times = centres_s_.segment(fit.first, fit.samples).array() - point.lag_s;
  return response(point.time_constant_s).mean(times, period_s_);
}

}  // namespace modebank
