#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/filter_step.hpp"
#include "filter/run_samples.hpp"

namespace modebank {

/// One moment of a run at which a filter stood: a sample, or a step between two samples that lie further apart.
struct Instant {
  Eigen::Index sample = -1;    ///< -1: between samples
  bool starts = false;         ///< the filter begins (anew) here
  Eigen::VectorXd start = {};  ///< from these measurements; empty elsewhere
};

/// All moments of a run with the inputs that led there, as filters step through them.
struct RunInstants {
  std::vector<Instant> instants;
  Eigen::MatrixXd inputs;  ///< m x instants: acting on the step into each

  RunInstants(const Bank& bank, const Trajectory& run, TimeSteps time_steps) {
    std::vector<Eigen::VectorXd> acting;
    RunSamples(bank, run, time_steps).for_each([&](const SampleFeed& feed, Eigen::Index k, bool starts) {
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

/// Takes `state` from the moment before to moment t of a run; false when there was nothing measured.
template <int N, int NY>
bool step_to(const FilterModel<N, NY>& model, const RunInstants& run, Eigen::Index t, const Trajectory& trajectory,
             FilterState<N>& state, FilterStep<N, NY>& step) {
  const Instant& instant = run.instants[static_cast<std::size_t>(t)];
  if (instant.starts) {
    start(model, instant.start, state);
    return true;
  }
  predict(model, state, run.inputs.col(t), step);
  if (instant.sample < 0) {
    skip_measurement(step, state);
    return false;
  }
  const auto y = trajectory.state.col(instant.sample);
  update(model, y, step, state);
  return step.partial.missing < y.size();
}

}  // namespace modebank
