#pragma once

#include <map>
#include <string>
#include <vector>

#include "ident/data/run_labels.hpp"
#include "ident/data/trajectory.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// Converts recorded labels into labels of the runs' samples. Each sample has the last label at or before its time;
/// samples before the first label have none.
class LabelHolder {
 public:
  /// `parts`: the runs into which `source` was split.
  void hold(const LabelStream& source, const std::vector<Trajectory>& parts);

  /// Labels in the order of `runs`; names in byte order.
  RunLabels of(const std::vector<Trajectory>& runs) const;

 private:
  std::map<std::string, std::vector<std::string>> of_run_;  // labels per sample, by run; empty: unknown
};

/// Checks that labels have few distinct values. Throws ConfigurationError for a label that differs in nearly every row,
/// like a measurement or a name of each row. Adds a doubt to `notes` if this is uncertain.
void check_labels(const std::string& column, const RunLabels& labels, std::vector<std::string>& notes);

}  // namespace modebank
