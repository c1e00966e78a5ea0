#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "app/chain/stage_inputs.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/line_stream.hpp"
#include "app/cli/track_input.hpp"
#include "app/cli/track_output.hpp"
#include "app/config/config_file.hpp"
#include "filter/step/alarm.hpp"
#include "filter/step/bank_filter.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/filter_checkpoint.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// The competitors of the bank run as evaluate runs them.
FilterOptions filter_options(const Config& config) {
  if (config.track.filter == TrackedFilter::bank) return config.filter;
  return competitor_filter(std::string(name_of(config.track.filter)), config.filter);
}

/// kf is the global model alone, whatever the bank.
std::string tracked_bank(const Config& config) {
  const bool single = config.track.filter == TrackedFilter::bank && config.filter.variant == FilterVariant::kf;
  return std::string(name_of(single ? TrackedFilter::baseline : config.track.filter));
}

/// A live filter between standard input and standard output.
class Tracker {
 public:
  Tracker(const std::string& archive, const Config& config)
      : config_(config),
        bank_(load_bank(archive, tracked_bank(config))),
        filter_(bank_, filter_options(config)),
        judge_(bank_, config.track.level, config.track.alarm),
        reader_({config.data.time, config.data.input, config.data.state}, config.track.format) {
    if (std::ssize(config.data.state) != bank_.C.rows() || std::ssize(config.data.input) != bank_.structure.inputs)
      throw ConfigurationError(fmt::format(
          "data.state and data.input name {} and {} columns, the bank of {} has {} states and {} inputs",
          config.data.state.size(), config.data.input.size(), archive, bank_.C.rows(), bank_.structure.inputs));
    const FilterOptions options = filter_options(config);
    identity_ = fmt::format("{} {} {} {} {} {}", archive_digest(archive), name_of(config.track.filter),
                            name_of(options.variant), name_of(options.noise), options.parameter_noise,
                            name_of(options.time_steps));
    if (!config.track.checkpoint.empty())
      if (const std::string obstacle = write_obstacle(config.track.checkpoint); !obstacle.empty())
        throw ConfigurationError(
            fmt::format("track.checkpoint: cannot write {}: {}", config.track.checkpoint, obstacle));
    if (!config.track.resume.empty()) {
      resume(config.track.resume);
    }
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
  Bank bank_;
  BankFilter filter_;
  LiveJudge judge_;
  SampleReader reader_;
  std::optional<EstimateWriter> writer_;
  std::string identity_;
  std::optional<double> last_time_s_;
  /// What was known before the last sample, if that came after so long a gap that the filter started anew.
  struct BeforeLeap {
    double time_s;
    FilterSnapshot filter;
  };
  std::optional<BeforeLeap> before_leap_;
  std::size_t line_number_ = 0, samples_ = 0;
  fmt::memory_buffer out_;

  void resume(const std::string& file) {
    const FilterSnapshot snapshot = load_checkpoint(file, identity_);
    try {
      filter_.restore(snapshot);
    } catch (const std::invalid_argument& error) {
      throw DataError(fmt::format("{}: {}", file, error.what()));
    }
    if (snapshot.samples.samples == 0) return;
    if (!std::isfinite(snapshot.samples.time_s)) throw DataError(file + ": the last sample has no time");
    last_time_s_ = snapshot.samples.time_s;
  }

  bool flush() {
    const bool read = write_out({out_.data(), out_.size()});
    out_.clear();
    return read;
  }

  void save() const { save_checkpoint(config_.track.checkpoint, identity_, filter_.snapshot()); }

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
    return SampleFeed::steps_between(from_s, to_s, bank_.dt_s, filter_options(config_).time_steps) > longest_gap_steps;
  }

  /// A sample far ahead whose successor follows the one before it had a wrong time: what was known before it is taken
  /// up again. Else a clock that goes back by more than a filter remembers is another clock.
  bool comes_in_time(double time_s) {
    if (!last_time_s_ || time_s > *last_time_s_) return true;
    if (before_leap_ && time_s > before_leap_->time_s && !is_gap(before_leap_->time_s, time_s)) {
      fmt::print(
          stderr,
          "modebank: line {}: time goes back from {} s to {} s, which follows {} s: the filter goes on from there\n",
          line_number_, *last_time_s_, time_s, before_leap_->time_s);
      filter_.restore(before_leap_->filter);
      last_time_s_ = before_leap_->time_s;
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
    before_leap_.reset();
    if (was_started && is_gap(*last_time_s_, sample.time_s))
      before_leap_ = BeforeLeap{*last_time_s_, filter_.snapshot()};
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
