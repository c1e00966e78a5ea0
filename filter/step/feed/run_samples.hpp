#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/feed/sample_feed.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"

/// A recorded run as filters need it: sample by sample, or moment by moment for random access. Filters and forecasts
/// are ImmFilter, DriftingFilter, DriftingForecast and those of the judge.
namespace modebank {

/// Throws std::invalid_argument if sizes of the bank do not fit each other, or do not fit the run. Throws DataError for
/// an input that is not finite.
void check_run(const Bank& bank, const Trajectory& run);

/// Time of a sample; NaN for a run without times.
inline double sample_time_s(const Trajectory& run, Eigen::Index k) {
  return run.time_s.size() > 0 ? run.time_s(k) : not_a_number;
}

/// Prepares the samples of a run for a filter. Calls visit(feed, k, starts) for every sample k from the first start on.
/// `starts`: whether the filter (re)starts at this sample.
template <class Visit>
void for_each_sample(const Bank& bank, const Trajectory& run, Visit visit) {
  SampleFeed feed(bank);
  bool started = false;
  for (Eigen::Index k = 0; k < run.samples(); ++k) {
    feed.push(sample_time_s(run, k), run.input.col(k).data(), run.state.col(k).data());
    started = started && feed.steps() <= longest_gap_steps;
    const bool starts = !started && feed.can_start();
    if (started || starts) visit(feed, k, starts);
    started = started || starts;
  }
}

/// One moment of a filtered run: a sample, or a model step between two distant samples.
struct Instant {
  Eigen::Index sample = -1;    ///< index of the sample; -1 between samples
  bool starts = false;         ///< whether the filter (re)starts here
  Eigen::VectorXd start = {};  ///< measurements for the start; empty at other moments
};

/// All moments of a run with the acting inputs, in the filter's order.
struct RunInstants {
  std::vector<Instant> instants;
  Eigen::MatrixXd inputs;  ///< m x instants; column t acts on the step to moment t

  RunInstants(const Bank& bank, const Trajectory& run) {
    std::vector<Eigen::VectorXd> acting;
    for_each_sample(bank, run, [&](const SampleFeed& feed, Eigen::Index k, bool starts) {
      for (Eigen::Index i = 1; !starts && i < feed.steps(); ++i) add({}, feed.inputs(), acting);
      add({k, starts, starts ? Eigen::VectorXd(feed.start()) : Eigen::VectorXd()}, feed.inputs(), acting);
    });
    inputs.resize(bank.structure.acting_inputs(), std::ssize(acting));
    for (std::size_t t = 0; t < acting.size(); ++t) inputs.col(static_cast<Eigen::Index>(t)) = acting[t];
  }

  Eigen::Index count() const { return std::ssize(instants); }
  /// Whether the moment after t belongs to the same stretch.
  bool continues(Eigen::Index t) const { return t + 1 < count() && !instants[static_cast<std::size_t>(t + 1)].starts; }

 private:
  void add(const Instant& instant, const Eigen::VectorXd& v, std::vector<Eigen::VectorXd>& acting) {
    instants.push_back(instant);
    acting.push_back(v);
  }
};

/// Advances a filter from the previous moment to moment t of a run. Returns the log density of the sample; NaN without
/// a prediction or a measured signal.
template <class Filter>
double follow(const RunInstants& run, Eigen::Index t, const Trajectory& trajectory, Filter& filter) {
  const Instant& instant = run.instants[static_cast<std::size_t>(t)];
  if (instant.sample >= 0 && !instant.starts) {
    filter.predict(run.inputs.col(t));
    return filter.update(trajectory.state.col(instant.sample));
  }
  if (instant.starts)
    filter.start(instant.start);
  else
    filter.step(run.inputs.col(t));
  return not_a_number;
}

}  // namespace modebank
