#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <exception>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "app/cli/commands.hpp"
#include "app/cli/line_stream.hpp"
#include "app/cli/live_filter.hpp"
#include "app/cli/track_input.hpp"
#include "app/cli/track_messages.hpp"
#include "app/cli/track_output.hpp"
#include "app/cli/track_thinning.hpp"
#include "app/cli/track_watchdog.hpp"
#include "app/config/config_file.hpp"
#include "filter/step/alarm.hpp"
#include "ident/base/utf8.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/filter_checkpoint.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// A live filter between standard input and standard output.
class Tracker {
 public:
  Tracker(const std::string& archive, const Config& config)
      : config_(config),
        opened_(open_filter(archive, config)),
        judge_(bank_, config.track.level, config.track.alarm),
        reader_({config.data.time.empty() ? "time" : config.data.time.front(), config.data.input, config.data.state},
                config.track.format),
        watchdog_(config.track.watchdog_s, now_s()),
        thinning_(opened_.options.time_steps == TimeSteps::single ? 0.0 : bank_.dt_s) {
    check_columns(config, bank_, archive);
    const FilterOptions& options = opened_.options;
    identity_ = fmt::format("{} {} {} {} {} {}", archive_digest(archive), name_of(config.track.filter),
                            name_of(options.variant), name_of(options.noise), options.parameter_noise,
                            name_of(options.time_steps));
    // The checkpoint that the filter goes on from may be replaced by the next.
    if (!config.track.checkpoint.empty())
      check_output({"track.checkpoint", config.track.checkpoint, checkpoint_form()}, {archive});
    if (config.track.resume.empty()) return;
    const Resumed resumed = filter_.resume(config.track.resume, identity_);
    if (std::isnan(resumed.time_s)) return;
    last_time_s_ = resumed.time_s;
    reader_.remember(resumed.input);
  }

  /// Whatever ends it: the estimates that are made leave, and what the filter knows is kept.
  void run() {
    lines_.emplace();
    std::exception_ptr trouble;
    try {
      follow();
    } catch (...) {
      trouble = std::current_exception();
    }
    try {
      flush();
      if (!config_.track.checkpoint.empty() && (!trouble || samples_ > 0)) save();
    } catch (...) {
      if (!trouble) throw;
    }
    if (trouble) std::rethrow_exception(trouble);
  }

 private:
  const Config& config_;
  OpenedFilter opened_;
  const Bank& bank_ = opened_.bank;
  LiveFilter& filter_ = *opened_.filter;
  LiveJudge judge_;
  SampleReader reader_;
  std::optional<EstimateWriter> writer_;
  std::string identity_;
  std::optional<double> last_time_s_;
  /// When the last sample came after so long a gap that the filter started anew: the time before, which the filter
  /// remembers.
  std::optional<double> before_leap_s_;
  std::size_t line_number_ = 0, samples_ = 0;
  fmt::memory_buffer out_;
  std::optional<LineStream> lines_;  ///< while it runs
  LiveMessages messages_;
  Watchdog watchdog_;
  SampleThinning thinning_;
  bool thinning_told_ = false, other_bytes_told_ = false;
  bool checkpoint_due_ = false, checkpoint_fails_ = false;

  static double now_s() { return std::chrono::duration<double>(LineStream::Clock::now().time_since_epoch()).count(); }

  void follow() {
    if (last_time_s_)
      messages_.say(
          fmt::format("goes on after the sample at {} s ({}); send what follows it, and drop what was written of later "
                      "samples: they are estimated again",
                      *last_time_s_, config_.track.resume));
    std::string_view line;
    for (auto got = next(line); got != LineStream::Got::end; got = next(line)) {
      if (got == LineStream::Got::waiting) {
        if (!flush()) break;
      } else if (got == LineStream::Got::overlong) {
        ++line_number_;
        complain("is too long for a sample");
      } else if (got == LineStream::Got::line) {
        ++line_number_;
        take(line);
        if (checkpoint_due_ && !before_leap_s_) {
          if (!flush()) break;
          keep();
        }
      }
    }
  }

  LineStream::Got next(std::string_view& line) {
    if (!watchdog_.on()) return lines_->next(line);
    if (const std::string text = watchdog_.due(now_s()); !text.empty())
      messages_.say(fmt::format("{:%Y-%m-%dT%H:%M:%SZ}: {}", fmt::gmtime(std::time(nullptr)), text));
    const LineStream::Got got = lines_->next(line, watchdog_.remaining_s(now_s()));
    if (got == LineStream::Got::line || got == LineStream::Got::overlong) watchdog_.heard();
    return got;
  }

  bool flush() {
    if (out_.size() == 0) return true;
    const bool read = write_out({out_.data(), out_.size()});
    out_.clear();
    if (watchdog_.on())
      watchdog_.answered(std::chrono::duration<double>(LineStream::Clock::now() - lines_->arrival()).count());
    return read;
  }

  void save() const { filter_.save(config_.track.checkpoint, identity_); }

  /// A checkpoint on the way, after the estimates that it knows have left: whoever goes on from it lacks none. One that
  /// cannot be written is no reason to stop, and is tried again when the next is due.
  void keep() {
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

  void complain(const std::string& reason) { messages_.say(fmt::format("line {}: {}; skipped", line_number_, reason)); }

  void take(std::string_view line) {
    if (!other_bytes_told_ && !is_utf8(line)) {
      messages_.say(fmt::format("line {}: {}", line_number_, read_as_windows_1252));
      other_bytes_told_ = true;
    }
    const SampleReader::Line kind = reader_.read(line);
    if (kind == SampleReader::Line::blank) return;
    if (kind == SampleReader::Line::malformed) return complain(reader_.reason());
    if (!writer_) {
      writer_.emplace(config_.data.state, bank_.mode_count(), reader_.format() == LineFormat::ndjson);
      writer_->header(out_);
    }
    if (kind == SampleReader::Line::sample && comes_in_time(reader_.sample().time_s) &&
        is_taken(reader_.sample().time_s)) {
      for (const std::string& remark : reader_.remarks())
        messages_.say(fmt::format("line {}: {}", line_number_, remark));
      step(reader_.sample());
    }
  }

  bool is_gap(double from_s, double to_s) const {
    return SampleFeed::steps_between(from_s, to_s, bank_.dt_s, opened_.options.time_steps) > longest_gap_steps;
  }

  /// A sample far ahead whose successor follows the one before it had a wrong time: what was known before it is taken
  /// up again. Else a clock that goes back by more than a filter remembers is another clock.
  bool comes_in_time(double time_s) {
    if (!last_time_s_ || time_s > *last_time_s_) return true;
    if (before_leap_s_ && time_s > *before_leap_s_ && !is_gap(*before_leap_s_, time_s)) {
      messages_.say(
          fmt::format("line {}: time goes back from {} s to {} s, which follows {} s: the filter goes on from there",
                      line_number_, *last_time_s_, time_s, *before_leap_s_));
      filter_.go_back();
      last_time_s_ = *before_leap_s_;
      return true;
    }
    if (*last_time_s_ - time_s > static_cast<double>(longest_gap_steps) * bank_.dt_s) {
      messages_.say(fmt::format("line {}: time goes back from {} s to {} s: the filter starts anew", line_number_,
                                *last_time_s_, time_s));
      filter_.restart();
      return true;
    }
    complain(fmt::format("time {} s is not after {} s", time_s, *last_time_s_));
    return false;
  }

  /// A log at 100 Hz, say, for a model that was learned at 10 Hz.
  bool is_taken(double time_s) {
    if (thinning_.takes(time_s)) return true;
    if (!thinning_told_)
      messages_.say(fmt::format(
          "line {}: a sample {:.3g} s after the one before, the archive's model steps {:.3g} s: one of each "
          "step is taken, the others get no line",
          line_number_, thinning_.since_s(), bank_.dt_s));
    thinning_told_ = true;
    return false;
  }

  void step(const LiveSample& sample) {
    const bool was_started = filter_.started();
    before_leap_s_.reset();
    if (was_started && is_gap(*last_time_s_, sample.time_s)) {
      before_leap_s_ = last_time_s_;
      filter_.remember();
    }
    const FilterEstimate& estimate = filter_.step(sample.time_s, sample.input, sample.measurement);
    if (was_started && estimate.steps == 0)
      messages_.say(fmt::format("line {}: {} s without a sample: the filter starts anew", line_number_,
                                sample.time_s - *last_time_s_));
    last_time_s_ = sample.time_s;
    writer_->line(sample.time_s, estimate, judge_.judge(estimate), out_);
    if (watchdog_.on()) watchdog_.took(sample.time_s, estimate.mode_probability);
    const auto interval = static_cast<std::size_t>(config_.track.checkpoint_interval);
    if (++samples_; interval > 0 && samples_ % interval == 0 && !config_.track.checkpoint.empty())
      checkpoint_due_ = true;
  }
};

}  // namespace

int run_track(const CommandLine& line) {
  if (line.files.size() != 1) throw ConfigurationError("track needs one archive: modebank track ARCHIVE");
  const std::string& archive = line.files.front();
  judge_archive(archive);
  const Config config = stored_config(load_configuration(archive), line.overrides);
  Tracker(archive, config).run();
  return 0;
}

}  // namespace modebank::app
