#include "app/cli/live_filter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "app/chain/stage_inputs.hpp"
#include "app/cli/combined_filter.hpp"
#include "filter/step/drifting.hpp"
#include "ident/base/not_a_number.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/filter_checkpoint.hpp"
#include "io/archive/load_combination.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// What every kind of filter does alike.
template <class Filter, class Snapshot>
class LiveOf : public LiveFilter {
 public:
  explicit LiveOf(Filter filter) : filter_(std::move(filter)) {}
  const FilterEstimate& step(double time_s, const Eigen::VectorXd& input, const Eigen::VectorXd& measurement) override {
    return filter_.step(time_s, input, measurement);
  }
  FilterEstimate forecast(double time_s, const Eigen::VectorXd& input) override {
    const Snapshot now = filter_.snapshot();
    const Eigen::VectorXd nothing = Eigen::VectorXd::Constant(filter_.estimate().innovation.size(), not_a_number);
    FilterEstimate ahead = filter_.step(time_s, input, nothing);
    filter_.restore(now);
    return ahead;
  }
  bool started() const override { return filter_.started(); }
  void restart() override { filter_.restart(); }
  void remember() override { remembered_ = filter_.snapshot(); }
  void go_back() override { filter_.restore(*remembered_); }

 protected:
  Filter filter_;

 private:
  std::optional<Snapshot> remembered_;
};

class LiveBank final : public LiveOf<BankFilter, FilterSnapshot> {
 public:
  using LiveOf::LiveOf;
  void save(const std::string& file, const std::string& identity) const override {
    save_checkpoint(file, identity, filter_.snapshot());
  }
  Resumed resume(const std::string& file, const std::string& identity) override {
    const FilterSnapshot snapshot = load_checkpoint(file, identity);
    try {
      filter_.restore(snapshot);
    } catch (const std::invalid_argument& error) {
      throw DataError(file + ": " + error.what());
    }
    if (snapshot.samples.samples == 0) return {not_a_number, {}};
    if (!std::isfinite(snapshot.samples.time_s)) throw DataError(file + ": the last sample has no time");
    return {snapshot.samples.time_s, snapshot.samples.inputs.col(0)};  // the newest
  }
};

class LiveDrifting final : public LiveOf<DriftingFilter, DriftingSnapshot> {
 public:
  using LiveOf::LiveOf;
  void save(const std::string&, const std::string&) const override { refuse(); }
  Resumed resume(const std::string&, const std::string&) override { refuse(); }
  /// Said before the first sample is read (open_filter).
  [[noreturn]] static void refuse() {
    throw ConfigurationError(
        "track.checkpoint and track.resume: what a drifting model remembers is not written; leave them out, or track "
        "another filter");
  }
};

}  // namespace

/// kf is the global model alone, whatever the bank.
std::string tracked_bank(const Config& config) {
  TrackedFilter filter = config.track.filter == TrackedFilter::combined ? TrackedFilter::bank : config.track.filter;
  if (filter == TrackedFilter::bank && config.filter.variant == FilterVariant::kf) filter = TrackedFilter::baseline;
  return std::string(name_of(filter));
}

FilterOptions tracked_options(const Config& config) {
  if (tracked_bank(config) == "bank") return config.filter;
  return competitor_filter(std::string(name_of(config.track.filter)), config.filter);
}

void check_columns(const Config& config, const Bank& bank, const std::string& archive) {
  if (std::ssize(config.data.state) == bank.C.rows() && std::ssize(config.data.input) == bank.structure.inputs) return;
  throw ConfigurationError(
      fmt::format("data.state and data.input name {} and {} columns, the bank of {} has {} states and {} inputs",
                  config.data.state.size(), config.data.input.size(), archive, bank.C.rows(), bank.structure.inputs));
}

void require_bank(const Config& config, const std::string& what) {
  if (config.track.filter == TrackedFilter::drifting)
    throw ConfigurationError(what + ": a model whose coefficients learn in every run is no bank");
  if (config.track.filter == TrackedFilter::combined)
    throw ConfigurationError(what + ": several filters together are no bank");
  if (config.track.filter == TrackedFilter::nonlinear)
    throw ConfigurationError(what + ": exported filters are linear; bank, baseline, noise_only and one_motion are");
}

namespace {

bool keeps_checkpoints(const Config& config) {
  return !config.track.checkpoint.empty() || !config.track.resume.empty();
}

OpenedFilter open_drifting(const std::string& archive, const FilterOptions& options) {
  const DriftingModel model = load_drifting(archive);
  return {fixed_bank(model), options, std::make_unique<LiveDrifting>(DriftingFilter(model, options.time_steps))};
}

OpenedFilter open_bank(const std::string& archive, const std::string& which, const FilterOptions& options) {
  Bank bank = load_bank(archive, which);
  auto filter = std::make_unique<LiveBank>(BankFilter(bank, options));
  return {std::move(bank), options, std::move(filter)};
}

/// The filters that the archive has combined one sample ahead, the bank first, with the weights that training left.
OpenedFilter open_combined(const std::string& archive, const Config& config) {
  std::vector<std::unique_ptr<LiveFilter>> filters;
  std::vector<double> start;
  std::optional<OpenedFilter> bank;
  for (const CombinationRow& row : load_combination(archive)) {
    if (row.role != Role::train || row.horizon != 1) continue;
    const FilterOptions options = row.filter == "bank" ? config.filter : competitor_filter(row.filter, config.filter);
    OpenedFilter opened =
        row.filter == "drifting" ? open_drifting(archive, options) : open_bank(archive, row.filter, options);
    filters.push_back(std::move(opened.filter));
    start.push_back(row.weight);
    if (!bank) bank = std::move(opened);
  }
  if (!bank) throw DataError(archive + ": holds no combined forecasts; run with filter.horizon = 1, 10 makes them");
  const double sum = std::accumulate(start.begin(), start.end(), 0.0);
  if (!(sum > 0.0)) start.assign(start.size(), 1.0);  // no training sample was scored
  return {bank->bank, bank->options, std::make_unique<CombinedFilter>(std::move(filters), start)};
}

}  // namespace

OpenedFilter open_filter(const std::string& archive, const Config& config) {
  const FilterOptions options = tracked_options(config);
  if (config.track.filter == TrackedFilter::combined) {
    if (keeps_checkpoints(config)) CombinedFilter::refuse();
    return open_combined(archive, config);
  }
  if (config.track.filter == TrackedFilter::drifting) {
    if (keeps_checkpoints(config)) LiveDrifting::refuse();
    return open_drifting(archive, options);
  }
  return open_bank(archive, tracked_bank(config), options);
}

}  // namespace modebank::app
