#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/step/drifting.hpp"
#include "filter/step/noise_density.hpp"
#include "filter/step/samples.hpp"
#include "ident/base/work_counter.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Inputs of all running variances and densities for one (q, p0, leak): e^2 / (1 + h'Ph), divided by v0, of each scored
/// signal, by output. Also the restarts of the running variance.
struct DriftTrace {
  std::vector<std::vector<double>> ratio;       ///< per output
  std::vector<std::vector<std::size_t>> start;  ///< per output: indices into `ratio`
  double log_variance = 0.0;                    ///< sum of log (v0 (1 + h'Ph)) over all scored signals
  Index samples = 0;

  explicit DriftTrace(std::size_t outputs) : ratio(outputs), start(outputs) {}

  void begin() {
    for (std::size_t i = 0; i < ratio.size(); ++i) start[i].push_back(ratio[i].size());
  }

  void add(const DriftingFilter& filter, const Eigen::VectorXd& v0) {
    for (Index i = 0; i < v0.size(); ++i) {
      const double e = filter.innovation()(i), growth = filter.growth(i);
      if (std::isnan(e)) continue;
      ratio[static_cast<std::size_t>(i)].push_back(e * e / growth / v0(i));
      log_variance += std::log(v0(i)) + std::log(growth);
    }
    ++samples;
  }
};

/// A training run, prepared for DriftingFilter.
struct TrainingRun {
  const Trajectory& trajectory;
  RunInstants instants;
};

std::vector<TrainingRun> training_runs(const Bank& bank, const Recording& recording) {
  std::vector<TrainingRun> runs;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    check_run(bank, run);
    runs.push_back({run, RunInstants(bank, run)});
  }
  return runs;
}

DriftTrace trace_drift(Bank bank, const DriftRates& rates, const std::vector<TrainingRun>& runs) {
  bank.drift.rates = rates;
  const Eigen::VectorXd v0 = bank.noise_variance();
  DriftTrace trace(static_cast<std::size_t>(v0.size()));
  DriftingFilter filter(bank);
  for (const TrainingRun& run : runs)
    for (Index t = 0; t < run.instants.count(); ++t) {
      const double log_density = follow(run.instants, t, run.trajectory, filter);
      if (run.instants.instants[static_cast<std::size_t>(t)].starts) trace.begin();
      if (!std::isnan(log_density)) trace.add(filter, v0);
    }
  return trace;
}

/// Sums of log densities for all (lam, nu, floor), floor fastest. Running variances of all (lam, floor) are in units of
/// v0.
void score_trace(const DriftTrace& trace, const DriftingGrid& grid, Eigen::Ref<Eigen::VectorXd> sums) {
  const Index floors = std::ssize(grid.floor), pairs = std::ssize(grid.lam) * floors;
  Eigen::ArrayXd floor(pairs), keep(pairs), v(pairs), square(pairs), log_variance = Eigen::ArrayXd::Zero(pairs);
  for (Index i = 0; i < pairs; ++i) {
    floor(i) = grid.floor[static_cast<std::size_t>(i % floors)];
    keep(i) = grid.lam[static_cast<std::size_t>(i / floors)];
  }
  const std::vector<StudentNoise> noises(grid.nu.begin(), grid.nu.end());
  // per nu: sums of log (1 + z^2 / (nu - 2)); of z^2 for the normal distribution
  Eigen::ArrayXXd tail = Eigen::ArrayXXd::Zero(pairs, std::ssize(noises));
  double signals = 0.0;
  for (std::size_t output = 0; output < trace.ratio.size(); ++output) {
    auto start = trace.start[output].begin();
    for (std::size_t t = 0; t < trace.ratio[output].size(); ++t) {
      for (; start != trace.start[output].end() && *start == t; ++start) v.setOnes();
      const double ratio = trace.ratio[output][t];
      square = ratio / v;
      log_variance += v.log();
      for (Index d = 0; const StudentNoise& noise : noises) {
        if (noise.gaussian())
          tail.col(d++) += square;
        else
          tail.col(d++) += (1.0 + square / (noise.degrees() - 2.0)).log();
      }
      v = (keep * v + (1.0 - keep) * ratio).max(floor);
      ++signals;
    }
  }
  for (Index d = 0; const StudentNoise& noise : noises) {
    const double weight = noise.gaussian() ? 0.5 : 0.5 * (noise.degrees() + 1.0);
    const Eigen::ArrayXd sum = signals * noise.log_constant() - 0.5 * log_variance - weight * tail.col(d);
    for (Index i = 0; i < pairs; ++i) sums((i / floors * tail.cols() + d) * floors + i % floors) = sum(i);
    ++d;
  }
  sums.array() -= 0.5 * trace.log_variance;
}

}  // namespace

std::array<Index, 6> DriftingGrid::point(Index index) const {
  const std::array<Index, 6> size = sizes();
  std::array<Index, 6> at{};
  for (std::size_t i = size.size(); i-- > 0; index /= size[i]) at[i] = index % size[i];
  return at;
}

Index DriftingScores::best() const {
  Index best = 0;
  for (Index i = 1; i < log_score.size(); ++i)
    if (is_below(log_score(best), log_score(i))) best = i;
  return best;
}

DriftingScores score_drifting_grid(const Bank& start, const Recording& recording, const DriftingGrid& grid) {
  const std::array<Index, 6> size = grid.sizes();
  for (const Index values : size)
    if (values == 0) throw std::invalid_argument("the drifting model's grid has a setting without values");
  const std::vector<TrainingRun> runs = training_runs(start, recording);
  const Index drifts = size[0] * size[1] * size[2], rest = size[3] * size[4] * size[5];
  DriftingScores scores{Eigen::VectorXd(drifts * rest), 0, Eigen::MatrixXd(start.structure.states, drifts)};
  std::vector<Index> samples(static_cast<std::size_t>(drifts), 0);
  WorkCounter counter("settings of the drifting model", static_cast<std::size_t>(drifts));
  tbb::parallel_for(Index{0}, drifts, [&](Index d) {
    counter.add();
    const std::array<Index, 6> at = grid.point(d * rest);
    const DriftRates rates{grid.q[static_cast<std::size_t>(at[0])], grid.p0[static_cast<std::size_t>(at[1])],
                           grid.leak[static_cast<std::size_t>(at[2])]};
    // without drift the leak has no effect, so one leak is tried
    if (rates.q == 0.0 && rates.p0 == 0.0 && at[2] > 0) return;
    const DriftTrace trace = trace_drift(start, rates, runs);
    score_trace(trace, grid, scores.log_score.segment(d * rest, rest));
    samples[static_cast<std::size_t>(d)] = trace.samples;
    for (std::size_t i = 0; i < trace.ratio.size(); ++i)
      scores.error_ratio(static_cast<Index>(i), d) =
          std::accumulate(trace.ratio[i].begin(), trace.ratio[i].end(), 0.0) /
          static_cast<double>(trace.ratio[i].size());
  });
  for (Index d = 0; d < drifts; ++d) {
    if (samples[static_cast<std::size_t>(d)] > 0 || d == 0) continue;
    const Index first = d - grid.point(d * rest)[2];
    scores.log_score.segment(d * rest, rest) = scores.log_score.segment(first * rest, rest);
    scores.error_ratio.col(d) = scores.error_ratio.col(first);
  }
  scores.samples = samples.front();
  if (scores.samples == 0) throw DataError("no training run has a sample on which a drifting model can be scored");
  scores.log_score /= static_cast<double>(scores.samples);
  return scores;
}

}  // namespace modebank
