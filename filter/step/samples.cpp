#include "filter/step/samples.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "modebank/base/error.hpp"

namespace modebank {

using Eigen::Index;

SampleFeed::SampleFeed(const Bank& bank)
    : inputs_(bank.structure.inputs),
      latest_delay_(bank.structure.input_delay.latest()),
      acting_inputs_(bank.structure.acting_inputs()),
      needed_samples_(static_cast<double>(bank.structure.first_transition() + 1)),
      dt_s_(bank.dt_s),
      // The acting inputs of sample k are the `input_lags` inputs u[k-d], u[k-d-1], ..., where d is the input's delay.
      recent_(Eigen::MatrixXd::Zero(inputs_, latest_delay_ + bank.structure.input_lags)),
      measurements_(Eigen::MatrixXd::Zero(bank.C.rows(), bank.structure.state_lags)) {
  for (Index i = 0; i < inputs_; ++i) ahead_.push_back(latest_delay_ - bank.structure.input_delay[i]);
}

Index SampleFeed::whole_steps(double periods) {
  if (std::isnan(periods)) return 1;
  return std::lround(std::clamp(periods, 1.0, static_cast<double>(longest_gap_steps + 1)));
}

void SampleFeed::settle() const {
  if (!recent_.allFinite() || !(samples_ >= whole_ && whole_ >= 0.0))
    throw std::invalid_argument("the snapshot has samples with invalid counts or inputs");
}

void check_run(const Bank& bank, const Trajectory& run) {
  check_sizes(bank);
  const auto mismatch = [&](const std::string& what, Index is, Index expected) {
    if (is != expected)
      throw std::invalid_argument("run " + run.run + " has " + std::to_string(is) + " " + what + ", the bank needs " +
                                  std::to_string(expected));
  };
  mismatch("measured signals", run.state.rows(), bank.C.rows());
  mismatch("inputs", run.input.rows(), bank.structure.inputs);
  mismatch("input samples", run.input.cols(), run.samples());
  if (run.time_s.size() > 0) mismatch("times", run.time_s.size(), run.samples());
  // one vectorised pass tests whether all entries are finite
  if ((run.input.leftCols(run.transitions()).array() * 0.0).sum() == 0.0) return;
  for (Index k = 0; k < run.transitions(); ++k)
    if (!run.input.col(k).allFinite())
      throw DataError("run " + run.run + ": the input of sample " + std::to_string(k) + " is not a finite number");
}

RunInstants::RunInstants(const Bank& bank, const Trajectory& run) {
  SampleFeed feed(bank);
  std::vector<double> acting;
  bool started = false;
  for (Index k = 0; k < run.samples(); ++k) {
    feed.push(sample_time_s(run, k), run.input.col(k).data(), run.state.col(k).data());
    started = started && feed.steps() <= longest_gap_steps;
    if (!started && !feed.can_start()) continue;
    const auto v = feed.inputs();
    for (Index i = started ? feed.steps() : 1; i > 0; --i) {
      instants.emplace_back();
      acting.insert(acting.end(), v.data(), v.data() + v.size());
    }
    instants.back().sample = k;
    instants.back().starts = !started;
    if (!started) instants.back().start = feed.start();
    started = true;
  }
  inputs = Eigen::MatrixXd::Map(acting.data(), bank.structure.acting_inputs(), count());
}

}  // namespace modebank
