#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "app/cli/aligned_samples.hpp"
#include "app/cli/line_table.hpp"
#include "app/config/config.hpp"

namespace modebank::app {

/// Reads samples from lines as they arrive. Samples are rows of a LineTable. For a missing input the last value is
/// repeated.
class SampleReader {
 public:
  explicit SampleReader(const DataOptions& data);

  enum class Line { sample, header, blank, left_out, malformed };
  /// Reads lines. Calls `take` for each line in order, with its number and one of:
  /// - `sample`: sample() returns the sample during the call;
  /// - `malformed`: reason() states the fault, and the line has no other effect;
  /// - `left_out`: data.where is false.
  ///
  /// Throws ConfigurationError with the existing columns if the header lacks a needed column.
  using Take = std::function<void(std::size_t, Line)>;
  void read(std::span<const std::string> lines, const Take& take);

  const TimedSample& sample() const { return sample_; }
  const std::string& reason() const { return reason_; }
  /// Remarks on values of the last sample that are too large for a filter.
  const std::vector<std::string>& remarks() const { return remarks_; }
  LineTable& table() { return table_; }

 private:
  DataOptions data_;
  LineTable table_;
  TimedSample sample_, next_;
  bool any_input_ = false;
  std::string reason_;
  std::vector<std::string> remarks_;

  void read_head(std::string line, std::size_t position, const Take& take);
  void read_rows(std::span<const std::string> lines, std::size_t position, const Take& take);
  Line accept(const Table& table, std::size_t row);
  Line malformed(std::string reason);
  /// Marks a value that is too large for a filter as missing, with a remark.
  void leave_out(double& value, const std::string& name, const char* instead);
};

}  // namespace modebank::app
