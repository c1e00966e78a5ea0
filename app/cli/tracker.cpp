#include "app/cli/tracker.hpp"

#include <csignal>
#include <utility>

#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

Tracker::Tracker(const OpenArchive& archive, const Config& config, OpenedFilter opened, const Alignment& alignment)
    : config_(config),
      opened_(std::move(opened)),
      validity_(load_input_range(archive), opened_.lags, bank_.dt_s),
      reader_(config.data),
      samples_(alignment),
      lag_s_(alignment.lag_s) {
  check_columns(config, bank_, archive);
}

void Tracker::restart() {
  filter_.restart();
  samples_.restart();
  validity_.restart();
}

void Tracker::follow_runs(const std::vector<Trajectory>& runs, bool named) {
  constexpr Eigen::Index flushed_after = 1000;
  constexpr double ns_per_s = 1e9;
  std::signal(SIGPIPE, SIG_IGN);  // if the reader of standard output has closed it, the stream ends without a signal
  open_writer({config_.track.json, named});
  for (const Trajectory& run : runs) {
    restart();
    last_s_.reset();
    before_leap_.reset();
    run_ = run.run;
    for (Eigen::Index k = 0; k < run.samples(); ++k) {
      place_ = fmt::format("run {}, sample {}", run_, k);
      const std::int64_t since_origin_ns = std::llround(run.time_s(k) * ns_per_s);
      const double time_s = run.time_origin_ns == 0 ? run.time_s(k)
                                                    : static_cast<double>(run.time_origin_ns + since_origin_ns) /
                                                          ns_per_s;  // as in its file
      take_sample({time_s, run.input.col(k), run.state.col(k)});
      if (k % flushed_after == 0 && !flush()) return;
    }
  }
}

void Tracker::follow_lines() {
  constexpr std::size_t most_at_once = 512;
  if (lag_s_ < 0.0)
    messages_.say(fmt::format(
        "inputs come {:.3g} s after the states that they act on. Each estimate waits for its input, but carries the "
        "time stamp of its sample",
        -lag_s_));
  if (lag_s_ > 0.0)
    messages_.say(fmt::format("inputs come {:.3g} s before the states that they act on: they are held back", lag_s_));
  LineStream& stream = lines_.emplace();
  std::vector<std::string> batch;
  std::string_view line;
  for (auto got = stream.next(line); got != LineStream::Got::end; got = stream.next(line)) {
    if (got == LineStream::Got::line && stream.is_unended()) {
      take_lines(batch);
      take_last_line({std::string(line)});
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
  if (stream.was_cut())
    messages_.say(fmt::format("line {}: the input was stopped inside this line, which is left out", line_number_ + 1));
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

/// The last line may be incomplete, because the writing program may have stopped inside it.
void Tracker::take_last_line(std::vector<std::string> line) {
  const bool whole = reader_.table().is_open() && reader_.table().is_whole(line.front());
  messages_.say(fmt::format("line {}: the last line has no line break at its end: {}", line_number_ + 1,
                            whole ? "it has all its fields and is used" : "fields are missing, so it is left out"));
  if (whole) take_lines(line);
}

void Tracker::take(SampleReader::Line kind) {
  for (const std::string& note : reader_.table().notes()) messages_.say_note("standard input", note);
  if (kind == SampleReader::Line::blank) return;
  if (kind == SampleReader::Line::malformed) return complain(reader_.reason());
  if (!writer_) open_writer({config_.track.json || reader_.table().has_objects(), false});
  if (kind == SampleReader::Line::left_out) return complain("data.where is false");
  if (kind != SampleReader::Line::sample) return;
  if (const auto first_s = reader_.table().corrected_first_s()) correct_first(*first_s);
  for (const std::string& remark : reader_.remarks()) messages_.say_once(place_, remark);
  take_sample(reader_.sample());
}

/// Takes samples in order of time. After a gap or a jump of the clock, the filter starts anew.
void Tracker::take_sample(const TimedSample& sample) {
  if (!comes_in_time(sample.time_s)) return;
  before_leap_.reset();
  if (last_s_ && filter_.started() && is_gap(*last_s_, sample.time_s)) {
    before_leap_ = BeforeLeap{*last_s_, samples_, validity_, filter_.snapshot()};
    samples_.restart();
  }
  first_.reset();
  if (++came_ == 1) {
    first_ = sample;
    first_at_ = out_.size();
  }
  last_s_ = sample.time_s;
  samples_.push(sample);
  while (const TimedSample* const ready = samples_.next()) step(*ready);
}

/// The second sample shows that the unit of times was wrong, so the first sample is filtered again.
void Tracker::correct_first(double time_s) {
  if (!first_) return;
  const bool has_left = !first_at_ && estimates_ > 0;
  if (has_left)
    messages_.say(fmt::format("{}: times are not in seconds; the first sample's time is {} s", place_, time_s));
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

/// If a sample jumps ahead but the next sample continues from before the jump, the time of the jumping sample was
/// wrong. The filter then returns to its state before the jump. A time that goes back by more than the filter's memory
/// belongs to another clock.
bool Tracker::comes_in_time(double time_s) {
  if (!last_s_ || time_s > *last_s_) return true;
  if (before_leap_ && time_s > before_leap_->time_s && !is_gap(before_leap_->time_s, time_s)) {
    messages_.say_once(
        place_, fmt::format("time goes back from {} s to {} s, which follows {} s: the filter goes on from there",
                            *last_s_, time_s, before_leap_->time_s));
    filter_.restore(before_leap_->filter);
    samples_ = before_leap_->samples;
    validity_ = before_leap_->validity;
    return true;
  }
  if (*last_s_ - time_s <= static_cast<double>(longest_gap_steps) * bank_.dt_s) {
    complain(fmt::format("time {} s is not after {} s", time_s, *last_s_));
    return false;
  }
  messages_.say_once(place_, fmt::format("time goes back from {} s to {} s: the filter starts anew", *last_s_, time_s));
  restart();
  last_s_.reset();
  return true;
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

void Tracker::open_writer(const EstimateLines& lines) {
  writer_.emplace(config_.data.state, bank_.mode_count(), lines);
  writer_->header(out_);
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

void Tracker::finish(bool failed) {
  messages_.say_repeats();
  flush();
  if (failed || estimates_ > 0 || came_ + refused_ == 0) return;
  if (refused_ > 0)
    throw DataError(fmt::format("no sample could be used: {} of {} were left out", refused_, refused_ + came_));
  throw DataError(
      fmt::format("no sample could be used: {} came, and inputs come {:.3g} s {} the states that they act on", came_,
                  std::abs(lag_s_), lag_s_ < 0.0 ? "after" : "before"));
}

}  // namespace modebank::app
