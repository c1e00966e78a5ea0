#include "app/cli/tracker.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <utility>

#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// Text that identifies the archive and all options that affect the filter's steps. A checkpoint has to have the same
/// text.
std::string identity_of(const OpenArchive& archive, const Config& config, const FilterOptions& options) {
  return fmt::format("{} {} {} {}", archive.digest(), name_of(config.track.filter), name_of(options.variant),
                     name_of(options.noise));
}

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
      judge_(bank_),
      forecast_judge_(judge_),
      validity_(load_input_range(archive), opened_.lags, bank_.dt_s),
      reader_(config.data),
      identity_(identity_of(archive, config, opened_.options)),
      samples_(alignment),
      alignment_(alignment),
      watchdog_(config.track.watchdog_s, LineStream::now_s()),
      thinning_(alignment.rate_hz > 0.0 ? 0.0 : bank_.dt_s) {
  check_columns(config, bank_, archive);
  if (!config.track.resume.empty()) go_on();
}

void Tracker::restart() {
  filter_.restart();
  samples_.restart();
  validity_.restart();
}

void Tracker::follow_runs(const std::vector<Trajectory>& runs, bool named) {
  constexpr Eigen::Index flushed_after = 1000;
  std::signal(SIGPIPE, SIG_IGN);  // if the reader of standard output has closed it, the stream ends without a signal
  open_writer({config_.track.json, named, config_.track.forecast});
  bool goes_on = resumed_s_.has_value();
  for (const Trajectory& run : runs) {
    if (!std::exchange(goes_on, false)) {
      restart();
      last_s_.reset();
      before_leap_.reset();
    }
    run_ = run.run;
    for (Eigen::Index k = 0; k < run.samples(); ++k) {
      place_ = fmt::format("run {}, sample {}", run_, k);
      take_sample({stamp_s(run, k), run.input.col(k), run.state.col(k)});
      if (checkpoint_due_ && !before_leap_) {
        flush();
        keep();
      }
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
  if (!config_.track.checkpoint.empty() && (!failed || estimates_ > 0)) save();
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
  if (watchdog_.on() && lines_)
    watchdog_.answered(std::chrono::duration<double>(LineStream::Clock::now() - lines_->arrival()).count());
  return read;
}

void Tracker::step(const TimedSample& sample) {
  const bool was_started = filter_.started();
  const FilterEstimate& estimate = filter_.step(sample.time_s, sample.input, sample.measurement);
  const double since_s = sample.time_s - std::exchange(stepped_s_, sample.time_s);
  if (was_started && estimate.steps == 0)
    messages_.say_once(place_, fmt::format("{} s without a sample: the filter starts anew", since_s));
  if (watchdog_.on()) watchdog_.took(sample.time_s, estimate.mode_probability);
  write(sample, estimate, validity_.judge(sample.time_s, sample.input, estimate, filter_.started()));
  const auto interval = static_cast<std::size_t>(config_.track.checkpoint_interval);
  if (++estimates_; interval > 0 && estimates_ % interval == 0 && !config_.track.checkpoint.empty())
    checkpoint_due_ = true;
}

void Tracker::write(const TimedSample& sample, const FilterEstimate& estimate, const ValidityFlags& flags) {
  if (!config_.track.forecast)
    return writer_->line(run_, sample.time_s, estimate, judge_.judge(estimate), flags, nullptr, out_);
  made_ = estimate;  // a copy, because the forecast below overwrites `estimate`
  const double now_s = std::max(sample.time_s, samples_.newest_s());
  const bool ahead = now_s > sample.time_s && filter_.started();
  const Forecast forecast{now_s, forecast_judge_.judge(ahead ? filter_.forecast(now_s, sample.input) : made_)};
  writer_->line(run_, sample.time_s, made_, judge_.judge(made_), flags, &forecast, out_);
}

}  // namespace modebank::app
