#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "app/cli/line_table.hpp"
#include "app/config/config.hpp"
#include "filter/step/feed/aligned_samples.hpp"

namespace modebank::app {

/// Reads samples from lines as they come: rows of a LineTable, with the held input where one is missing.
class SampleReader {
 public:
  explicit SampleReader(const DataOptions& data);

  enum class Line { sample, header, blank, left_out, malformed };
  /// Reads lines and calls `take` for each in order, with its position. During a call, sample() is that of a `sample`,
  /// and reason() is the fault of a `malformed` line, of which nothing is kept. `left_out`: data.where is false. Throws
  /// ConfigurationError, with the existing columns, for a header without a needed column.
  void read(const std::vector<std::string>& lines, const std::function<void(std::size_t, Line)>& take);

  const TimedSample& sample() const { return sample_; }
  const std::string& reason() const { return reason_; }
  /// Remarks on numbers of the last sample that are too large for a filter.
  const std::vector<std::string>& remarks() const { return remarks_; }
  /// Sets the held input, for a next sample that lacks one: that of the sample before the first line.
  void remember(const Eigen::VectorXd& input);
  LineTable& table() { return table_; }

 private:
  using Take = std::function<void(std::size_t, Line)>;
  DataOptions data_;
  LineTable table_;
  TimedSample sample_, next_;
  bool any_input_ = false;
  std::string reason_;
  std::vector<std::string> remarks_;

  struct Rows {
    std::vector<std::string> lines;
    std::vector<std::size_t> positions;
  };
  void read_head(std::string line, std::size_t position, const Take& take);
  void read_rows(const Rows& rows, const Take& take);
  Line accept(const Table& table, std::size_t row);
  Line malformed(std::string reason);
  /// Makes a number that is too large for a filter missing, with a remark.
  void leave_out(double& value, const std::string& name, const char* instead);
};

}  // namespace modebank::app
