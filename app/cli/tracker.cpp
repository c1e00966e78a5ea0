#include "app/cli/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// Time of a sample in seconds, as in its file.
double stamp_s(const Trajectory& run, Eigen::Index k) {
  constexpr double ns_per_s = 1e9;
  if (run.time_origin_ns == 0) return run.time_s(k);
  return static_cast<double>(run.time_origin_ns + std::llround(run.time_s(k) * ns_per_s)) / ns_per_s;
}

}  // namespace

Tracker::Tracker(const OpenArchive& archive, const Config& config, OpenedFilter opened, const Alignment& alignment)
    : config_(config),
      opened_(std::move(opened)),
      validity_(load_input_range(archive), opened_.lags, bank_.dt_s),
      reader_(config.data),
      samples_(alignment),
      alignment_(alignment) {
  check_columns(config, bank_, archive);
}

void Tracker::restart() {
  filter_.restart();
  samples_.restart();
  validity_.restart();
}

void Tracker::follow_runs(const std::vector<Trajectory>& runs, bool named) {
  constexpr Eigen::Index flushed_after = 1000;
  std::signal(SIGPIPE, SIG_IGN);  // if the reader of standard output has closed it, the stream ends without a signal
  open_writer({config_.track.json, named});
  for (const Trajectory& run : runs) {
    restart();
    last_s_.reset();
    before_leap_.reset();
    run_ = run.run;
    for (Eigen::Index k = 0; k < run.samples(); ++k) {
      place_ = fmt::format("run {}, sample {}", run_, k);
      take_sample({stamp_s(run, k), run.input.col(k), run.state.col(k)});
      if (k % flushed_after == 0 && !flush()) return;
    }
  }
}

void Tracker::open_writer(const EstimateLines& lines) {
  writer_.emplace(config_.data.state, bank_.mode_count(), lines);
  writer_->header(out_);
}

void Tracker::finish(bool failed) {
  messages_.say_repeats();
  flush();
  if (failed || estimates_ > 0 || came_ + refused_ == 0) return;
  if (refused_ > 0)
    throw DataError(fmt::format("no sample could be used: {} of {} were left out", refused_, refused_ + came_));
  throw DataError(
      fmt::format("no sample could be used: {} came, and inputs come {:.3g} s {} the states that they act on", came_,
                  std::abs(alignment_.lag_s), alignment_.lag_s < 0.0 ? "after" : "before"));
}

void Tracker::complain(const std::string& reason) {
  ++refused_;
  messages_.say_once(place_, reason + "; skipped");
}

bool Tracker::flush() {
  if (out_.size() == 0) return true;
  const bool read = write_out({out_.data(), out_.size()});
  out_.clear();
  first_at_.reset();
  return read;
}

void Tracker::step(const TimedSample& sample) {
  const bool was_started = filter_.started();
  const FilterEstimate& estimate = filter_.step(sample.time_s, sample.input, sample.measurement);
  const double since_s = sample.time_s - std::exchange(stepped_s_, sample.time_s);
  if (was_started && estimate.steps == 0)
    messages_.say_once(place_, fmt::format("{} s without a sample: the filter starts anew", since_s));
  // One interval alone may be jitter.
  const double of_two_s = since_s + std::exchange(since_s_, was_started ? since_s : HUGE_VAL);
  if (was_started && since_s > 0.0 && of_two_s < 1.25 * bank_.dt_s)
    messages_.say_once(place_, fmt::format("a sample {:.3g} s after the one before counts as a whole step of {:.3g} s; "
                                           "--data.rate_hz {:.6g} brings the samples to the model's rate",
                                           since_s, bank_.dt_s, 1.0 / bank_.dt_s));
  ++estimates_;
  judge_live(bank_.C, estimate, verdict_);
  writer_->line(run_, sample.time_s, estimate, verdict_,
                validity_.judge(sample.time_s, sample.input, estimate, filter_.started()), out_);
}

}  // namespace modebank::app
