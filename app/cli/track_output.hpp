#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "filter/step/alarm.hpp"
#include "filter/step/bank_filter.hpp"

namespace modebank::app {

/// Writes estimates as lines of CSV under a header, or of NDJSON. What is not known is empty, or null.
class EstimateWriter {
 public:
  EstimateWriter(std::vector<std::string> states, Eigen::Index modes, bool as_json);

  /// Appends the header, which NDJSON has none of.
  void header(fmt::memory_buffer& out) const;
  void line(double time_s, const FilterEstimate& estimate, const LiveVerdict& verdict, fmt::memory_buffer& out) const;

 private:
  std::vector<std::string> states_;
  Eigen::Index modes_;
  bool json_;
};

}  // namespace modebank::app
