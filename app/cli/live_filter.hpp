#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "filter/step/any_filter.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app {

/// The point at which a filter continues: time of the last sample (NaN without samples), number of samples since its
/// start, and the last inputs.
struct Resumed {
  double time_s;
  Eigen::Index samples;
  Eigen::VectorXd input;
};

/// Save and restore the filter's state. Both throw as save_checkpoint and load_checkpoint do, and ConfigurationError
/// for a filter that is not a bank.
void save(AnyFilter& filter, const std::string& file, const std::string& identity);
Resumed resume(AnyFilter& filter, const std::string& file, const std::string& identity);

/// The configured filter. `bank` gives its sizes and period; `lags` is the number of samples before it starts.
struct OpenedFilter {
  Bank bank;
  FilterOptions options;
  Eigen::Index lags;
  std::unique_ptr<AnyFilter> filter;
};
/// Throws ConfigurationError for filters that are not banks. `what`: the action, for the error message.
void require_bank(const Config& config, const std::string& what);
/// Name of the archive's bank that the configuration selects; for combined filters the first of them.
std::string tracked_bank(const Config& config);
/// Options of the filter; for competitors those of `evaluate`.
FilterOptions tracked_options(const Config& config);
/// Throws ConfigurationError unless the number of columns is that of the bank.
void check_columns(const Config& config, const Bank& bank, const OpenArchive& archive);
/// The filters that an archive combines at a horizon (0: free run), the bank first, with their start weights. If the
/// archive lacks this horizon, the longest one is used. Throws DataError for an archive without combinations.
struct CombinedMembers {
  std::vector<std::string> names;
  std::vector<double> weights;
};
CombinedMembers combined_members(const OpenArchive& archive, Eigen::Index horizon);
/// Throws as load_bank does, and ConfigurationError for options that the filter does not have.
OpenedFilter open_filter(const OpenArchive& archive, const Config& config);

}  // namespace modebank::app
