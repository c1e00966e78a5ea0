#pragma once

#include <string>

#include "app/config/config.hpp"
#include "filter/step/combined_filter.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app {

/// The configured filter. `bank` determines its sizes and period. `lags` is the number of samples that it needs before
/// it starts.
struct OpenedFilter {
  Bank bank;
  FilterOptions options;
  Eigen::Index lags;
  CombinedFilter filter;
};
/// Throws ConfigurationError for filters that are not banks. `what`: the action, for the error message.
void require_bank(const Config& config, const std::string& what);
/// Name of the archive's bank that the configuration selects, unless it combines all of them.
std::string tracked_bank(const Config& config);
/// Options of the filter. Competitors use the options that `run` uses.
FilterOptions tracked_options(const Config& config);
/// Throws ConfigurationError unless the configured columns are as many as the bank's channels.
void check_columns(const Config& config, const Bank& bank, const OpenArchive& archive);
/// Throws the exceptions of load_bank, and ConfigurationError for options that the filter does not have.
OpenedFilter open_filter(const OpenArchive& archive, const Config& config);

}  // namespace modebank::app
