#include "ident/lag/track.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/data/averaged_stream.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/fit/scale.hpp"
#include "ident/lag/delayed_regression.hpp"
#include "ident/lag/objective.hpp"

namespace modebank {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index half_grid = 100;        // number of lags on each side of zero
constexpr Index most_pairs = 20000;     // largest number of samples; longer runs are thinned
constexpr Index least_pairs = 20;       // smallest number of samples in a window
constexpr double least_coverage = 0.8;  // smallest share of a window's inputs for which a state is known at the lag

/// Averaged states at the inputs' times plus each lag of the grid.
class ShiftedStates {
 public:
  ShiftedStates(const Stream& states, const VectorXd& time_s, double width_s, double range_s)
      : series_(AveragedStream::linear(states)), time_s_(time_s), step_s_(range_s / half_grid) {
    for (Index i = -half_grid; i <= half_grid; ++i)
      shifted_.push_back(series_.mean((time_s.array() + lag(i)).matrix(), width_s));
  }
  double lag(Index i) const { return static_cast<double>(i) * step_s_; }
  double step_s() const { return step_s_; }

  /// The samples of [first, first + count) for which a state is known lag(i) later; empty if there are too few.
  Eigen::Vector2<Index> covered(Index i, Index first, Index count) const {
    Index from = first, end = first + count;
    while (from < end && time_s_(from) + lag(i) < series_.first_s()) ++from;
    while (end > from && time_s_(end - 1) + lag(i) > series_.last_s()) --end;
    const bool enough = static_cast<double>(end - from) >= least_coverage * static_cast<double>(count);
    return enough && end - from >= least_pairs ? Eigen::Vector2<Index>(from, end - from) : Eigen::Vector2<Index>(0, 0);
  }
  /// Averages of the states lag(i) later than the inputs, n x N.
  const MatrixXd& at(Index i) const { return shifted_[static_cast<std::size_t>(i + half_grid)]; }

 private:
  AveragedStream series_;
  VectorXd time_s_;
  double step_s_;
  std::vector<MatrixXd> shifted_;
};

/// Predictions B u of the states at the time of each input, n x N. B is fitted to the whole run at the lag of the best
/// fit.
MatrixXd predictions(const ShiftedStates& states, const MatrixXd& inputs) {
  MatrixXd coefficients = MatrixXd::Zero(states.at(0).rows(), inputs.rows());
  double least = 1.0;
  for (Index i = -half_grid; i <= half_grid; ++i) {
    const Eigen::Vector2<Index> covered = states.covered(i, 0, inputs.cols());
    const Index first = covered(0), count = covered(1);
    if (count == 0) continue;
    const VectorXd ones = VectorXd::Ones(count);
    const MatrixXd x = centred(inputs.middleCols(first, count), ones);
    const MatrixXd y = centred(states.at(i).middleCols(first, count), ones);
    const MatrixXd B = regress_rows(x, y, ones);
    const VectorXd rest = (y - B * x).rowwise().squaredNorm(), total = y.rowwise().squaredNorm();
    const double share = (total.array() > 0.0).select(rest.array() / total.array(), 1.0).mean();
    if (share >= least) continue;
    least = share;
    coefficients = B;
  }
  return coefficients * inputs;
}

/// Squared correlation of the predictions with the states lag(i) later (zero if the correlation is negative), mean over
/// the states.
double agreement(const ShiftedStates& states, const MatrixXd& predicted, Index i, Index first, Index count) {
  const Eigen::Vector2<Index> covered = states.covered(i, first, count);
  if (covered(1) == 0) return 0.0;
  const VectorXd ones = VectorXd::Ones(covered(1));
  const MatrixXd z = centred(predicted.middleCols(covered(0), covered(1)), ones);
  const MatrixXd y = centred(states.at(i).middleCols(covered(0), covered(1)), ones);
  double sum = 0.0;
  for (Index s = 0; s < y.rows(); ++s) {
    const double scale = z.row(s).norm() * y.row(s).norm();
    const double correlation = scale > 0.0 ? std::max(z.row(s).dot(y.row(s)) / scale, 0.0) : 0.0;
    sum += correlation * correlation;
  }
  return sum / static_cast<double>(y.rows());
}

struct Match {
  double lag_s = 0.0, r_squared = 0.0;
  bool interior = false;
};

Match best_match(const ShiftedStates& states, const MatrixXd& predicted, Index first, Index count) {
  VectorXd profile(2 * half_grid + 1);
  for (Index i = -half_grid; i <= half_grid; ++i)
    profile(i + half_grid) = agreement(states, predicted, i, first, count);
  Index best = 0;
  Match match;
  match.r_squared = profile.maxCoeff(&best);
  match.lag_s = states.lag(best - half_grid);
  match.interior = best > 0 && best < 2 * half_grid && profile(best - 1) > 0.0 && profile(best + 1) > 0.0;
  if (!match.interior) return match;
  const double curvature = profile(best - 1) - 2.0 * profile(best) + profile(best + 1);
  if (curvature < 0.0) match.lag_s += 0.5 * states.step_s() * (profile(best - 1) - profile(best + 1)) / curvature;
  return match;
}

Stream thinned(const Stream& inputs) {
  const Index stride = (inputs.time_s.size() + most_pairs - 1) / most_pairs;
  std::vector<Index> kept;
  for (Index k = 0; k < inputs.time_s.size(); k += std::max<Index>(stride, 1)) kept.push_back(k);
  return {inputs.time_s(kept), inputs.values(Eigen::all, kept)};
}

}  // namespace

double LagTrack::median_s() const { return median(lag_s); }
double LagTrack::least_s() const { return windows() > 0 ? lag_s.minCoeff() : not_a_number; }
double LagTrack::largest_s() const { return windows() > 0 ? lag_s.maxCoeff() : not_a_number; }

LagTrack track_lag(const Stream& states, const Stream& inputs, const LagTrackOptions& options) {
  const Stream y = without_missing(states), u = thinned(with_last_known(inputs));
  if (u.values.rows() == 0 || y.time_s.size() < least_pairs || u.time_s.size() < least_pairs) return {};
  const double period_s = median_period_s(u.time_s), span_s = u.time_s(u.time_s.size() - 1) - u.time_s(0);
  const double window_s = std::min(options.window_s, span_s + period_s);
  const ShiftedStates shifted(y, u.time_s, period_s, std::min(options.range_s, 0.25 * span_s));
  const MatrixXd predicted = predictions(shifted, u.values);
  std::vector<double> times, lags, correlations;
  Index first = 0;
  for (double start = u.time_s(0); start + window_s <= u.time_s(0) + span_s + 1.5 * period_s; start += 0.5 * window_s) {
    while (first < u.time_s.size() && u.time_s(first) < start) ++first;
    // A pause may hold many windows without samples. Continue at the first window with samples.
    if (first < u.time_s.size())
      start += 0.5 * window_s * std::max(0.0, std::floor((u.time_s(first) - window_s - start) / (0.5 * window_s)));
    if (!(start + 0.5 * window_s > start)) break;  // at times so far from zero, a double does not resolve a step
    Index end = first;
    while (end < u.time_s.size() && u.time_s(end) < start + window_s) ++end;
    if (end - first < least_pairs) continue;
    const Match match = best_match(shifted, predicted, first, end - first);
    if (!match.interior || !(std::sqrt(match.r_squared) > options.correlation)) continue;
    times.push_back(start + 0.5 * window_s);
    lags.push_back(match.lag_s);
    correlations.push_back(std::sqrt(match.r_squared));
  }
  const auto vector = [](const std::vector<double>& v) {
    return VectorXd(Eigen::Map<const VectorXd>(v.data(), static_cast<Index>(v.size())));
  };
  return {vector(times), vector(lags), vector(correlations)};
}

}  // namespace modebank
