#include "app/cli/live_filter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "app/chain/stage_inputs.hpp"
#include "filter/step/drifting.hpp"
#include "ident/base/not_a_number.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/filter_checkpoint.hpp"
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
  const bool single = config.track.filter == TrackedFilter::bank && config.filter.variant == FilterVariant::kf;
  return std::string(name_of(single ? TrackedFilter::baseline : config.track.filter));
}

FilterOptions tracked_options(const Config& config) {
  if (config.track.filter == TrackedFilter::bank) return config.filter;
  return competitor_filter(std::string(name_of(config.track.filter)), config.filter);
}

void check_columns(const Config& config, const Bank& bank, const std::string& archive) {
  if (std::ssize(config.data.state) == bank.C.rows() && std::ssize(config.data.input) == bank.structure.inputs) return;
  throw ConfigurationError(
      fmt::format("data.state and data.input name {} and {} columns, the bank of {} has {} states and {} inputs",
                  config.data.state.size(), config.data.input.size(), archive, bank.C.rows(), bank.structure.inputs));
}

OpenedFilter open_filter(const std::string& archive, const Config& config) {
  const TrackedFilter tracked = config.track.filter;
  const FilterOptions options = tracked_options(config);
  if (tracked == TrackedFilter::drifting) {
    if (!config.track.checkpoint.empty() || !config.track.resume.empty()) LiveDrifting::refuse();
    const DriftingModel model = load_drifting(archive);
    return {fixed_bank(model), options, std::make_unique<LiveDrifting>(DriftingFilter(model, options.time_steps))};
  }
  Bank bank = load_bank(archive, tracked_bank(config));
  auto filter = std::make_unique<LiveBank>(BankFilter(bank, options));
  return {std::move(bank), options, std::move(filter)};
}

}  // namespace modebank::app
