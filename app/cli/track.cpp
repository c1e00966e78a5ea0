#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "app/cli/commands.hpp"
#include "app/cli/line_stream.hpp"
#include "app/cli/live_filter.hpp"
#include "app/cli/track_input.hpp"
#include "app/cli/track_output.hpp"
#include "app/config/config_file.hpp"
#include "filter/step/alarm.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/files/replace_file.hpp"
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
                config.track.format) {
    check_columns(config, bank_, archive);
    const FilterOptions& options = opened_.options;
    identity_ = fmt::format("{} {} {} {} {} {}", archive_digest(archive), name_of(config.track.filter),
                            name_of(options.variant), name_of(options.noise), options.parameter_noise,
                            name_of(options.time_steps));
    if (!config.track.checkpoint.empty())
      if (const std::string obstacle = write_obstacle(config.track.checkpoint); !obstacle.empty())
        throw ConfigurationError(
            fmt::format("track.checkpoint: cannot write {}: {}", config.track.checkpoint, obstacle));
    if (config.track.resume.empty()) return;
    if (const double time_s = filter_.resume(config.track.resume, identity_); !std::isnan(time_s))
      last_time_s_ = time_s;
  }

  void run() {
    LineStream lines;
    std::string_view line;
    for (auto got = lines.next(line); got != LineStream::Got::end; got = lines.next(line)) {
      if (got == LineStream::Got::waiting) {
        if (!flush()) break;
        continue;
      }
      ++line_number_;
      if (got == LineStream::Got::overlong)
        complain("is too long for a sample");
      else
        take(line);
    }
    flush();
    if (!config_.track.checkpoint.empty()) save();
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

  bool flush() {
    const bool read = write_out({out_.data(), out_.size()});
    out_.clear();
    return read;
  }

  void save() const { filter_.save(config_.track.checkpoint, identity_); }

  void complain(const std::string& reason) const {
    fmt::print(stderr, "modebank: line {}: {}; skipped\n", line_number_, reason);
  }

  void take(std::string_view line) {
    const SampleReader::Line kind = reader_.read(line);
    if (kind == SampleReader::Line::blank) return;
    if (kind == SampleReader::Line::malformed) return complain(reader_.reason());
    if (!writer_) {
      writer_.emplace(config_.data.state, bank_.mode_count(), reader_.format() == LineFormat::ndjson);
      writer_->header(out_);
    }
    if (kind == SampleReader::Line::sample && comes_in_time(reader_.sample().time_s)) step(reader_.sample());
  }

  bool is_gap(double from_s, double to_s) const {
    return SampleFeed::steps_between(from_s, to_s, bank_.dt_s, opened_.options.time_steps) > longest_gap_steps;
  }

  /// A sample far ahead whose successor follows the one before it had a wrong time: what was known before it is taken
  /// up again. Else a clock that goes back by more than a filter remembers is another clock.
  bool comes_in_time(double time_s) {
    if (!last_time_s_ || time_s > *last_time_s_) return true;
    if (before_leap_s_ && time_s > *before_leap_s_ && !is_gap(*before_leap_s_, time_s)) {
      fmt::print(
          stderr,
          "modebank: line {}: time goes back from {} s to {} s, which follows {} s: the filter goes on from there\n",
          line_number_, *last_time_s_, time_s, *before_leap_s_);
      filter_.go_back();
      last_time_s_ = *before_leap_s_;
      return true;
    }
    if (*last_time_s_ - time_s > static_cast<double>(longest_gap_steps) * bank_.dt_s) {
      fmt::print(stderr, "modebank: line {}: time goes back from {} s to {} s: the filter starts anew\n", line_number_,
                 *last_time_s_, time_s);
      filter_.restart();
      return true;
    }
    complain(fmt::format("time {} s is not after {} s", time_s, *last_time_s_));
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
      fmt::print(stderr, "modebank: line {}: {} s without a sample: the filter starts anew\n", line_number_,
                 sample.time_s - *last_time_s_);
    last_time_s_ = sample.time_s;
    writer_->line(sample.time_s, estimate, judge_.judge(estimate), out_);
    const auto interval = static_cast<std::size_t>(config_.track.checkpoint_interval);
    if (++samples_; interval > 0 && samples_ % interval == 0 && !config_.track.checkpoint.empty()) save();
  }
};

}  // namespace

int run_track(const CommandLine& line) {
  if (line.files.size() != 1) throw ConfigurationError("track needs one archive: modebank track ARCHIVE");
  const std::string& archive = line.files.front();
  const Config config = stored_config(load_configuration(archive), line.overrides);
  Tracker(archive, config).run();
  return 0;
}

}  // namespace modebank::app
