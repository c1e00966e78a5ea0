#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "app/config/config.hpp"

namespace modebank::app {

/// One sample as it arrived.
struct LiveSample {
  double time_s = 0.0;
  Eigen::VectorXd input;        ///< m
  Eigen::VectorXd measurement;  ///< n_y, NaN where missing
};

/// Where a sample's numbers stand: column names of a CSV header, members of a JSON object.
struct SampleColumns {
  std::string time;
  std::vector<std::string> inputs, states;
};

/// Reads samples from lines. The first line decides between CSV (a header that names columns) and NDJSON (an object per
/// line) unless the format is given.
class SampleReader {
 public:
  SampleReader(SampleColumns columns, LineFormat format);

  enum class Line { sample, header, blank, malformed };
  /// Takes one line in; after `sample` it is in sample(), after `malformed` the reason is in reason(). A header without
  /// a needed column throws ConfigurationError, which lists those there are. Of a malformed line nothing is kept.
  Line read(std::string_view line);
  const LiveSample& sample() const { return sample_; }
  /// What acts where the next sample misses an input: that of a sample before the first line.
  void remember(const Eigen::VectorXd& input);
  const std::string& reason() const { return reason_; }
  /// Of the last sample's numbers those that are too large to reckon with, and what becomes of them.
  const std::vector<std::string>& remarks() const { return remarks_; }
  LineFormat format() const { return format_; }

 private:
  SampleColumns columns_;
  LineFormat format_;
  LiveSample sample_, next_;
  std::vector<std::size_t> positions_;  ///< in a CSV line: time, inputs, states; empty before the header
  std::size_t fields_ = 0;              ///< per CSV line
  std::string reason_;
  std::vector<std::string> remarks_;
  bool any_input_ = false;

  Line malformed(std::string reason);
  Line read_header(std::string_view line);
  bool read_csv(std::string_view line);
  bool read_json(std::string_view line);
  /// Number `i` of time, inputs, states; NaN: missing.
  double& slot(std::size_t i);
  const std::string& name(std::size_t i) const;
  std::size_t slots() const { return 1 + columns_.inputs.size() + columns_.states.size(); }
  Line accept();
  /// Of a number that no filter can reckon with: it is missing.
  void leave_out(double& value, const std::string& name, const char* instead);
};

}  // namespace modebank::app
