#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "filter/step/any_filter.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app {

/// Where a filter goes on: the time of the last sample it knows, NaN without samples, how many it has had since it
/// started anew, and the last one's inputs.
struct Resumed {
  double time_s;
  Eigen::Index samples;
  Eigen::VectorXd input;
};

/// Writes what the filter remembers, and goes on from it. Throw as save_checkpoint and load_checkpoint do, and
/// ConfigurationError for a filter that has another form than a bank.
void save(AnyFilter& filter, const std::string& file, const std::string& identity);
Resumed resume(AnyFilter& filter, const std::string& file, const std::string& identity);

/// The filter that the configuration asks for. `bank`: whose sizes and period it has; `lags`: samples that it needs to
/// start.
struct OpenedFilter {
  Bank bank;
  FilterOptions options;
  Eigen::Index lags;
  std::unique_ptr<AnyFilter> filter;
};
/// Throws ConfigurationError for filters that are no bank: `what` is done with banks alone.
void require_bank(const Config& config, const std::string& what);
/// Which of an archive's banks the configuration asks for; of combined the first of them.
std::string tracked_bank(const Config& config);
/// How it steps: competitors run as evaluate runs them.
FilterOptions tracked_options(const Config& config);
/// Throws ConfigurationError when the columns named are more or fewer than the bank has.
void check_columns(const Config& config, const Bank& bank, const OpenArchive& archive);
/// The filters that an archive has combined at a horizon (0: in free run), the bank first, and the weights that they
/// start with; of the longest horizon where it has none of this one. Throws DataError where it has none at all.
struct CombinedMembers {
  std::vector<std::string> names;
  std::vector<double> weights;
};
CombinedMembers combined_members(const OpenArchive& archive, Eigen::Index horizon);
/// Throws as load_bank does, and ConfigurationError for what the filter cannot do.
OpenedFilter open_filter(const OpenArchive& archive, const Config& config);

}  // namespace modebank::app
