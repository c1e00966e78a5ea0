#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "app/cli/line_table.hpp"
#include "app/config/config.hpp"
#include "filter/step/feed/aligned_samples.hpp"

namespace modebank::app {

/// Reads samples from lines as they come: the rows of a LineTable with what acts where an input is missing.
class SampleReader {
 public:
  explicit SampleReader(const DataOptions& data);

  enum class Line { sample, header, blank, left_out, malformed };
  /// Takes lines in and calls `take` for each in order, with its position. While it runs sample() is that of a
  /// `sample`, and reason() says why a line is `malformed`: nothing of it is kept. `left_out`: data.where is false. A
  /// header without a needed column throws ConfigurationError, which lists those there are.
  void read(const std::vector<std::string>& lines, const std::function<void(std::size_t, Line)>& take);

  const TimedSample& sample() const { return sample_; }
  const std::string& reason() const { return reason_; }
  /// Which of the last sample's numbers are too large for a filter, and what becomes of them.
  const std::vector<std::string>& remarks() const { return remarks_; }
  /// Sets the input that acts where the next sample lacks one: that of the sample before the first line.
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
  /// Makes a number that is too large for a filter a missing one, with a remark.
  void leave_out(double& value, const std::string& name, const char* instead);
};

}  // namespace modebank::app
