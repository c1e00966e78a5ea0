#include "filter/step/feed/sample_feed.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "filter/step/equations/bounds.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Every column takes the place of the one after it; the newest stays in the first. (Plain loops here and in push: a
/// filter's step takes less time than Eigen's expressions of sizes that it does not know.)
void shift(Eigen::MatrixXd& newest_first) {
  double* column = newest_first.data();
  for (Index i = newest_first.size() - 1; i >= newest_first.rows(); --i) column[i] = column[i - newest_first.rows()];
}

}  // namespace

SampleFeed::SampleFeed(const Bank& bank, TimeSteps time_steps)
    : inputs_(bank.structure.inputs),
      input_delay_(bank.structure.input_delay),
      acting_inputs_(bank.structure.acting_inputs()),
      first_transition_(bank.structure.first_transition()),
      time_steps_(time_steps),
      dt_s_(bank.dt_s),
      // v holds u[k-d], u[k-d-1], ... of sample k: input_lags of them from d back.
      recent_(Eigen::MatrixXd::Zero(inputs_, input_delay_ + bank.structure.input_lags)),
      measurements_(Eigen::MatrixXd::Zero(bank.C.rows(), bank.structure.state_lags)) {}

void SampleFeed::clear() { samples_ = whole_ = 0; }

Index SampleFeed::steps_between(double from_s, double to_s, double dt_s, TimeSteps time_steps) {
  const double periods = (to_s - from_s) / dt_s;
  if (time_steps == TimeSteps::single || !(dt_s > 0.0) || !std::isfinite(periods)) return 1;
  return std::lround(std::clamp(periods, 1.0, static_cast<double>(longest_gap_steps + 1)));
}

void SampleFeed::push(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                      const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  if (input.size() != inputs_ || measurement.size() != measurements_.rows())
    throw std::invalid_argument("a sample of " + std::to_string(input.size()) + " inputs and " +
                                std::to_string(measurement.size()) + " measurements, the bank has " +
                                std::to_string(inputs_) + " and " + std::to_string(measurements_.rows()));
  steps_ = samples_ == 0 ? 1 : steps_between(time_s_, time_s, dt_s_, time_steps_);
  if (steps_ > longest_gap_steps) clear();
  shift(recent_);
  for (Index i = 0; i < inputs_; ++i)
    if (std::isfinite(input(i))) recent_(i) = input(i);  // else the last known one still acts
  shift(measurements_);
  for (Index i = 0; i < measurement.size(); ++i) measurements_(i) = measurement(i);
  whole_ = missing_entries(measurement) == 0 ? whole_ + 1 : 0;
  ++samples_;
  time_s_ = time_s;
}

void SampleFeed::restore(const Memory& memory) {
  if (memory.inputs.rows() != recent_.rows() || memory.inputs.cols() != recent_.cols() ||
      memory.measurements.rows() != measurements_.rows() || memory.measurements.cols() != measurements_.cols())
    throw std::invalid_argument("the remembered samples are not those of this bank");
  if (!memory.inputs.allFinite() || memory.samples < 0 || memory.whole < 0 || memory.whole > memory.samples)
    throw std::invalid_argument("the remembered samples are none that a filter has");
  recent_ = memory.inputs;
  measurements_ = memory.measurements;
  samples_ = memory.samples;
  whole_ = memory.whole;
  time_s_ = memory.time_s;
}

}  // namespace modebank
