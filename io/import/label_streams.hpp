#pragma once

#include <map>
#include <string>
#include <vector>

#include "ident/data/run_labels.hpp"
#include "ident/data/trajectory.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// The labels of runs as they were recorded become those of the runs' samples: the last one at or before each, none
/// before the first.
class LabelHolder {
 public:
  /// What `source` was made into: `parts` of it.
  void hold(const LabelStream& source, const std::vector<Trajectory>& parts);

  /// In the order of `runs`; names in byte order.
  RunLabels of(const std::vector<Trajectory>& runs) const;

 private:
  std::map<std::string, std::vector<std::string>> of_run_;  // by run, per sample; empty: unknown
};

/// Whether they can be names of a few kinds. Throws ConfigurationError for what is another in nearly every row, as a
/// measurement or a row's own name; what `notes` gets is a doubt.
void check_labels(const std::string& column, const RunLabels& labels, std::vector<std::string>& notes);

}  // namespace modebank
