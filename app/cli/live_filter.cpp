#include "app/cli/live_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "filter/judge/combination.hpp"
#include "filter/learn/chain/inputs.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/load_combination.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

/// The filter kf always uses the global model.
std::string tracked_bank(const Config& config) {
  const bool single = config.track.filter == TrackedFilter::bank && config.filter.variant == FilterVariant::kf;
  return std::string(name_of(single ? TrackedFilter::baseline : config.track.filter));
}

namespace {

FilterOptions options_of(const std::string& which, const Config& config) {
  return which == "bank" ? config.filter : competitor_filter(which);
}

OpenedFilter open_bank(const OpenArchive& archive, const std::string& which, const Config& config) {
  Bank bank = load_bank(archive, which);
  const FilterOptions options = options_of(which, config);
  CombinedFilter filter(BankFilter(bank, options));
  const Eigen::Index lags = std::max(bank.structure.state_lags, bank.structure.first_transition() + 1);
  return {std::move(bank), options, lags, std::move(filter)};
}

/// The filters that the archive combines one sample ahead, with their weights after training. The bank is the first.
OpenedFilter open_combined(const OpenArchive& archive, const Config& config) {
  const std::vector<CombinationRow> rows = load_combination(archive);
  std::vector<std::string> names;
  for (const CombinationRow& row : rows)
    if (row.role == Role::train && row.horizon == 1) names.push_back(row.filter);
  if (names.empty())
    throw DataError(archive.path().string() +
                    ": the archive has no combined forecasts; make it again with modebank run");
  std::vector<BankFilter> filters;
  std::optional<OpenedFilter> bank;
  Eigen::Index lags = 0;
  for (const std::string& name : names) {
    OpenedFilter opened = open_bank(archive, name, config);
    filters.emplace_back(opened.bank, opened.options);
    lags = std::max(lags, opened.lags);
    if (!bank) bank = std::move(opened);
  }
  return {combined_frame(bank->bank), bank->options, lags,
          CombinedFilter(std::move(filters), start_weights(rows, 1, names))};
}

}  // namespace

FilterOptions tracked_options(const Config& config) { return options_of(tracked_bank(config), config); }

void check_columns(const Config& config, const Bank& bank, const OpenArchive& archive) {
  if (std::ssize(config.data.state) == bank.C.rows() && std::ssize(config.data.input) == bank.structure.inputs) return;
  throw ConfigurationError(
      fmt::format("data.state and data.input name {} and {} columns, the bank of {} has {} states and {} inputs",
                  config.data.state.size(), config.data.input.size(), archive.path().string(), bank.C.rows(),
                  bank.structure.inputs));
}

void require_bank(const Config& config, const std::string& what) {
  if (config.track.filter == TrackedFilter::drifting)
    throw ConfigurationError(what + ": a model whose coefficients learn in every run is not a bank");
  if (config.track.filter == TrackedFilter::combined)
    throw ConfigurationError(what + ": combined filters are not a bank");
  if (config.track.filter == TrackedFilter::nonlinear)
    throw ConfigurationError(what + ": exported filters are linear; use bank, baseline, noise_only or one_motion");
}

OpenedFilter open_filter(const OpenArchive& archive, const Config& config) {
  if (config.track.filter == TrackedFilter::combined) return open_combined(archive, config);
  return open_bank(archive, tracked_bank(config), config);
}

}  // namespace modebank::app
