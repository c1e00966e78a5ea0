#include "app/cli/tracker.hpp"

#include <fmt/chrono.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>

#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

double now_s() { return std::chrono::duration<double>(LineStream::Clock::now().time_since_epoch()).count(); }

/// Names the archive and all options of the filter's steps, which a checkpoint must share.
std::string identity_of(const OpenArchive& archive, const Config& config, const FilterOptions& options) {
  return fmt::format("{} {} {} {}", archive.digest(), name_of(config.track.filter), name_of(options.variant),
                     name_of(options.noise));
}

/// Seconds of a sample as its file has them.
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
      watchdog_(config.track.watchdog_s, now_s()),
      thinning_(alignment.rate_hz > 0.0 ? 0.0 : bank_.dt_s) {
  check_columns(config, bank_, archive);
  if (!config.track.resume.empty()) go_on();
}

void Tracker::go_on() {
  const Resumed resumed = resume(filter_, config_.track.resume, identity_);
  if (std::isnan(resumed.time_s)) return;
  resumed_s_ = stepped_s_ = resumed.time_s;
  validity_.go_on(resumed.samples, resumed.time_s);
  last_s_ = resumed.time_s - alignment_.reach_s();
  reader_.remember(resumed.input);
  samples_.go_on_after(resumed.time_s);
  messages_.say(fmt::format(
      "goes on after the sample at {} s ({}); send what follows {}, and drop what was written of later "
      "samples: they are estimated again",
      resumed.time_s, config_.track.resume, *last_s_ < resumed.time_s ? fmt::format("{} s", *last_s_) : "it"));
}

void Tracker::restart() {
  filter_.restart();
  samples_.restart();
  validity_.restart();
}

void Tracker::follow_lines() {
  constexpr std::size_t most_at_once = 512;
  const double lag_s = alignment_.lag_s;
  if (lag_s < 0.0)
    messages_.say(fmt::format(
        "inputs come {:.3g} s after the states that they act on: each estimate waits for its input and has the time "
        "that it is for. {}",
        -lag_s,
        config_.track.forecast ? "The columns of now forecast to the newest sample"
                               : "--track.forecast true adds the forecast to the newest sample"));
  if (lag_s > 0.0)
    messages_.say(fmt::format("inputs come {:.3g} s before the states that they act on: they are held back", lag_s));
  lines_.emplace();
  std::vector<std::string> batch;
  std::string_view line;
  for (auto got = next(line); got != LineStream::Got::end; got = next(line)) {
    if (got == LineStream::Got::line && lines_->is_unended()) {
      const std::string last(line);
      take_lines(batch);
      take_last_line(last);
      continue;
    }
    if (got == LineStream::Got::line) batch.emplace_back(line);
    if (got == LineStream::Got::line && batch.size() < most_at_once) continue;
    take_lines(batch);
    if (got == LineStream::Got::waiting && !flush()) break;
    if (got != LineStream::Got::overlong) continue;
    place_ = fmt::format("line {}", ++line_number_);
    complain("is too long for a sample");
  }
  take_lines(batch);
  if (lines_->was_cut()) messages_.say(fmt::format("line {}: stopped within it; it is left out", line_number_ + 1));
}

LineStream::Got Tracker::next(std::string_view& line) {
  if (!watchdog_.on()) return lines_->next(line);
  if (const std::string text = watchdog_.due(now_s()); !text.empty())
    messages_.say(fmt::format("{:%Y-%m-%dT%H:%M:%SZ}: {}", fmt::gmtime(std::time(nullptr)), text));
  const LineStream::Got got = lines_->next(line, watchdog_.remaining_s(now_s()));
  if (got == LineStream::Got::line || got == LineStream::Got::overlong) watchdog_.line_arrived();
  return got;
}

void Tracker::take_lines(std::vector<std::string>& lines) {
  if (lines.empty()) return;
  reader_.read(lines, [&](std::size_t position, SampleReader::Line kind) {
    place_ = fmt::format("line {}", line_number_ + position + 1);
    take(kind);
  });
  line_number_ += lines.size();
  lines.clear();
}

/// The program that writes may have ended within it.
void Tracker::take_last_line(const std::string& line) {
  const bool whole = reader_.table().is_open() && reader_.table().is_whole(line);
  messages_.say(fmt::format("line {}: the last line has no line break at its end: {}", line_number_ + 1,
                            whole ? "it has all its fields and is taken" : "fields are missing, it is left out"));
  std::vector<std::string> last{line};
  if (whole) take_lines(last);
}

void Tracker::take(SampleReader::Line kind) {
  for (const std::string& note : reader_.table().notes()) messages_.say_note("standard input", note);
  if (kind == SampleReader::Line::blank) return;
  if (kind == SampleReader::Line::malformed) return complain(reader_.reason());
  if (!writer_) open_writer({config_.track.json || reader_.table().has_objects(), false, config_.track.forecast});
  if (kind == SampleReader::Line::left_out) return complain("data.where is false");
  if (kind != SampleReader::Line::sample) return;
  if (const auto first_s = reader_.table().corrected_first_s()) correct_first(*first_s);
  for (const std::string& remark : reader_.remarks()) messages_.say_once(place_, remark);
  take_sample(reader_.sample());
  if (!checkpoint_due_ || before_leap_) return;
  flush();
  keep();
}

void Tracker::follow_runs(const std::vector<Trajectory>& runs, bool named) {
  constexpr Eigen::Index flushed_after = 1000;
  std::signal(SIGPIPE, SIG_IGN);  // a reader that goes away ends the stream
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

void Tracker::save() const { app::save(filter_, config_.track.checkpoint, identity_); }

/// Saves a checkpoint on the way, after the estimates that it covers have left, so that a program that goes on from it
/// lacks none. Where it cannot be written the filter goes on, and tries again when the next one is due.
void Tracker::keep() {
  checkpoint_due_ = false;
  try {
    save();
    if (checkpoint_fails_) messages_.say(fmt::format("{} is written again", config_.track.checkpoint));
    checkpoint_fails_ = false;
  } catch (const DataError& error) {
    if (!checkpoint_fails_)
      messages_.say(fmt::format("{}: the filter goes on without, and tries again every {} samples", error.what(),
                                config_.track.checkpoint_interval));
    checkpoint_fails_ = true;
  }
}

void Tracker::take_sample(const TimedSample& sample) {
  if (!comes_in_time(sample.time_s)) return;
  before_leap_.reset();
  if (last_s_ && filter_.started() && is_gap(*last_s_, sample.time_s)) {
    before_leap_ = BeforeLeap{*last_s_, samples_, validity_};
    filter_.remember();
    samples_.restart();
  }
  if (++came_ == 1) {
    first_ = sample;
    first_at_ = out_.size();
  } else {
    first_.reset();
  }
  last_s_ = sample.time_s;
  samples_.push(sample);
  while (const TimedSample* const ready = samples_.next())
    if (is_taken(ready->time_s)) step(*ready);
}

/// The second sample has shown what times count: the first one is filtered again.
void Tracker::correct_first(double time_s) {
  if (!first_) return;
  const bool has_left = !first_at_ && estimates_ > 0;
  if (has_left)
    messages_.say(fmt::format("{}: times count another unit than seconds; the first sample's is {} s", place_, time_s));
  first_->time_s = time_s;
  first_->rest_s = 0.0;
  last_s_ = time_s;
  restart();
  samples_.push(*first_);
  const TimedSample* const ready = samples_.next();
  if (ready == nullptr) return;
  if (has_left) {
    const FilterEstimate& estimate = filter_.step(ready->time_s, ready->input, ready->measurement);
    validity_.judge(ready->time_s, ready->input, estimate, filter_.started());
    return;
  }
  out_.resize(*first_at_);
  estimates_ = 0;
  step(*ready);
}

bool Tracker::is_gap(double from_s, double to_s) const {
  return SampleFeed::steps_between(from_s, to_s, bank_.dt_s) > longest_gap_steps;
}

/// A sample far ahead whose successor follows the one before it had a wrong time: what was known before it is taken
/// up again. Else a clock that goes back by more than a filter remembers is another clock.
bool Tracker::comes_in_time(double time_s) {
  if (!last_s_ || time_s > *last_s_) return true;
  if (before_leap_ && time_s > before_leap_->time_s && !is_gap(before_leap_->time_s, time_s)) {
    messages_.say_once(
        place_, fmt::format("time goes back from {} s to {} s, which follows {} s: the filter goes on from there",
                            *last_s_, time_s, before_leap_->time_s));
    filter_.go_back();
    samples_ = before_leap_->samples;
    validity_ = before_leap_->validity;
    return true;
  }
  if (*last_s_ - time_s > static_cast<double>(longest_gap_steps) * bank_.dt_s) {
    messages_.say_once(place_,
                       fmt::format("time goes back from {} s to {} s: the filter starts anew", *last_s_, time_s));
    restart();
    last_s_.reset();
    resumed_s_.reset();
    return true;
  }
  complain(fmt::format("time {} s is not after {} s", time_s, *last_s_));
  return false;
}

/// A log at 100 Hz, say, for a model that was learned at 10 Hz.
bool Tracker::is_taken(double time_s) {
  if (resumed_s_ && time_s <= *resumed_s_) return false;
  if (thinning_.takes(time_s)) return true;
  if (!std::exchange(thinning_told_, true))
    messages_.say(
        fmt::format("{}: a sample {:.3g} s after the one before, the archive's model steps {:.3g} s: one of "
                    "each step is taken, the others get no line",
                    place_, thinning_.since_s(), bank_.dt_s));
  return false;
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
  made_ = estimate;  // the filter forecasts in its place
  const double now_s = std::max(sample.time_s, samples_.newest_s());
  const bool ahead = now_s > sample.time_s && filter_.started();
  const Forecast forecast{now_s, forecast_judge_.judge(ahead ? filter_.forecast(now_s, sample.input) : made_)};
  writer_->line(run_, sample.time_s, made_, judge_.judge(made_), flags, &forecast, out_);
}

}  // namespace modebank::app
