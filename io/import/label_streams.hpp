#pragma once

#include <map>
#include <string>
#include <vector>

#include "ident/data/run_labels.hpp"
#include "ident/data/trajectory.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// Turns recorded labels into labels of the runs' samples: each sample has the last label at or before it; samples
/// before the first label have none.
class LabelHolder {
 public:
  /// `parts`: the runs that were made of `source`.
  void hold(const LabelStream& source, const std::vector<Trajectory>& parts);

  /// Labels in the order of `runs`; names in byte order.
  RunLabels of(const std::vector<Trajectory>& runs) const;

 private:
  std::map<std::string, std::vector<std::string>> of_run_;  // labels per sample, by run; empty: unknown
};

/// Checks that labels name a few kinds. Throws ConfigurationError for a label that differs in nearly every row, as
/// measurements and names of rows do. Adds a doubt to `notes` where this is uncertain.
void check_labels(const std::string& column, const RunLabels& labels, std::vector<std::string>& notes);

}  // namespace modebank
