#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/aligned_samples.hpp"
#include "app/cli/line_stream.hpp"
#include "app/cli/live_filter.hpp"
#include "app/cli/track_input.hpp"
#include "app/cli/track_output.hpp"
#include "app/config/config.hpp"
#include "filter/step/bank_filter.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank::app {

/// Runs a live filter: reads samples and writes estimates to standard output.
class Tracker {
 public:
  /// `alignment`: how the coming samples are aligned. Throws ConfigurationError if the bank has other columns.
  Tracker(const OpenArchive& archive, const Config& config, OpenedFilter opened, const Alignment& alignment);

  /// Filters samples from standard input, line by line, until the input ends.
  void follow_lines();
  /// Filters the samples of recorded runs. `named`: lines contain the run's name.
  void follow_runs(const std::vector<Trajectory>& runs, bool named);
  /// Ends the stream, also after an error: writes the remaining estimates. Throws DataError if no sample could be used.
  void finish(bool failed);

 private:
  /// The filter's state before a jump in time. After the jump the filter started anew.
  struct BeforeLeap {
    double time_s;
    AlignedSamples samples;
    ValidityJudge validity;
    CombinedFilter::Snapshot filter;
  };

  const Config& config_;
  OpenedFilter opened_;
  const Bank& bank_ = opened_.bank;
  CombinedFilter& filter_ = opened_.filter;
  LiveVerdict verdict_;
  ValidityJudge validity_;
  SampleReader reader_;
  std::optional<EstimateWriter> writer_;
  std::string run_, place_;
  AlignedSamples samples_;
  double lag_s_;
  double stepped_s_ = 0.0;        ///< time of the last estimate
  double since_s_ = HUGE_VAL;     ///< between the last two estimates
  std::optional<double> last_s_;  ///< time of the last sample
  std::optional<BeforeLeap> before_leap_;
  std::optional<TimedSample> first_;     ///< the first sample; kept until the second one arrives
  std::optional<std::size_t> first_at_;  ///< position of the first estimate in out_; empty after it was written
  std::size_t line_number_ = 0, came_ = 0, refused_ = 0, estimates_ = 0;
  fmt::memory_buffer out_;
  std::optional<LineStream> lines_;  ///< set while standard input is read, and until the last estimates are written
  LiveMessages messages_;

  void restart();
  void take_lines(std::vector<std::string>& lines);
  void take_last_line(std::vector<std::string> line);
  void take(SampleReader::Line kind);
  void take_sample(const TimedSample& sample);
  void open_writer(const EstimateLines& lines);
  void correct_first(double time_s);
  bool comes_in_time(double time_s);
  bool is_gap(double from_s, double to_s) const;
  void step(const TimedSample& sample);
  void complain(const std::string& reason);
  bool flush();
};

}  // namespace modebank::app
