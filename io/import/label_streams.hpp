#pragma once

#include <map>
#include <string>
#include <vector>

#include "ident/data/run_labels.hpp"
#include "ident/data/trajectory.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// Converts recorded labels into labels of the runs' samples. Each sample has the last label at or before its time.
/// Samples before the first label have no label.
class LabelHolder {
 public:
  /// `parts`: the runs into which `source` was split.
  void hold(const LabelStream& source, const std::vector<Trajectory>& parts);

  /// Labels in the order of `runs`. Their names are in byte order.
  RunLabels of(const std::vector<Trajectory>& runs) const;

 private:
  std::map<std::string, std::vector<std::string>> of_run_;  // labels of each run's samples; empty: unknown
};

/// Checks that labels have few distinct values. Throws ConfigurationError if the label differs in nearly every row, as
/// measurements or row names do. Adds a remark to `notes` if this is uncertain.
void check_labels(const std::string& column, const RunLabels& labels, std::vector<std::string>& notes);

}  // namespace modebank
