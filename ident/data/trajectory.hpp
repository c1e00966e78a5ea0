#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank {

using Eigen::Index;

struct Channel {
  std::string name;
  std::string unit;       ///< unit of the channel; empty if unknown
  bool averaged = false;  ///< true: the column is reduced to a lower rate by means over the steps (AveragedColumns);
                          ///< false: by single samples
};

std::vector<std::string> names_of(const std::vector<Channel>& channels);

/// Median interval between successive times over all series (the upper of two middle ones); 0 without intervals.
double median_period_s(const std::vector<const Eigen::VectorXd*>& times_s);
double median_period_s(const Eigen::VectorXd& time_s);

enum class Role { train, test };

template <>
struct EnumNames<Role> {
  static constexpr Names<2> values{"train", "test"};
};

/// One recorded run of N samples. Signals have one sample per column, so column k of `state` is x[k].
struct Trajectory {
  std::string run;  ///< name of the run
  Role role = Role::train;
  Eigen::VectorXd time_s;           ///< N sample times, strictly increasing
  Eigen::MatrixXd state;            ///< n x N, measured state
  Eigen::MatrixXd input;            ///< m x N
  Eigen::MatrixXd truth;            ///< n x N, true state; empty if unknown
  double lag_s = 0.0;               ///< lag applied to the inputs
  std::int64_t time_origin_ns = 0;  ///< ns since 1970 at time_s = 0, if the log has absolute times
  std::string file = {};            ///< file of the run's inputs; empty if there was none

  /// Signals in memory of the calling program: n and m rows of N columns. `state` and `input` are then empty. Windows
  /// of linear models with one-step residuals read the signals through states() and inputs(). No other function accepts
  /// such a run.
  struct Kept {
    const double *state = nullptr, *input = nullptr;
    Index states = 0, inputs = 0, samples = 0;
  };
  Kept kept = {};

  using Signals = Eigen::Map<const Eigen::MatrixXd>;
  Signals states() const {
    return kept.state ? Signals(kept.state, kept.states, kept.samples)
                      : Signals(state.data(), state.rows(), state.cols());
  }
  Signals inputs() const {
    return kept.state ? Signals(kept.input, kept.inputs, kept.samples)
                      : Signals(input.data(), input.rows(), input.cols());
  }
  Index samples() const { return kept.state ? kept.samples : state.cols(); }
  /// Transition k leads from sample k to sample k + 1.
  Index transitions() const { return samples() > 0 ? samples() - 1 : 0; }
};

/// All runs of one study object with the same channels in the same order, sorted by run name.
struct Recording {
  std::vector<Channel> states;  ///< n
  std::vector<Channel> inputs;  ///< m
  std::vector<Trajectory> runs;
  Eigen::VectorXd quantum = {};  ///< n, spacing of the possible values of each state [state unit]; 0 for a continuous
                                 ///< state. Empty if all states are continuous

  Index state_count() const { return static_cast<Index>(states.size()); }
  Index input_count() const { return static_cast<Index>(inputs.size()); }
  /// Number of transitions in all runs of this role.
  Index transitions(Role role) const {
    Index sum = 0;
    for (const Trajectory& run : runs) sum += run.role == role ? run.transitions() : 0;
    return sum;
  }
  /// Median sample period over all runs [s]; 0 without any transition.
  double median_period_s() const;
};

}  // namespace modebank
