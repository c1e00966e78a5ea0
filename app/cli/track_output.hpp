#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "app/cli/validity_flags.hpp"
#include "filter/step/bank_filter.hpp"

namespace modebank::app {

/// Format of the output lines, and their optional fields.
struct EstimateLines {
  bool json = false;  ///< NDJSON instead of CSV with a header
  bool run = false;   ///< lines contain the name of the run
};

/// Writes estimates as lines of CSV or NDJSON. An unknown value is empty in CSV and null in NDJSON.
class EstimateWriter {
 public:
  EstimateWriter(std::vector<std::string> states, Eigen::Index modes, const EstimateLines& lines);

  /// Appends the CSV header. NDJSON has no header.
  void header(fmt::memory_buffer& out) const;
  void line(const std::string& run, double time_s, const FilterEstimate& estimate, const LiveVerdict& verdict,
            const ValidityFlags& flags, fmt::memory_buffer& out) const;

 private:
  std::vector<std::string> states_;
  Eigen::Index modes_;
  EstimateLines lines_;

  void signal(std::size_t state, std::initializer_list<double> values, std::initializer_list<const char*> names,
              fmt::memory_buffer& out) const;
};

}  // namespace modebank::app
