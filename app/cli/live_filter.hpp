#pragma once

#include <memory>
#include <string>

#include "app/config/config.hpp"
#include "filter/step/bank_filter.hpp"

namespace modebank::app {

/// Where a filter goes on: the time of the last sample it knows, NaN without samples, and that sample's inputs.
struct Resumed {
  double time_s;
  Eigen::VectorXd input;
};

/// One of an archive's filters at work: a bank's, the drifting model's or several together.
class LiveFilter {
 public:
  virtual ~LiveFilter() = default;
  virtual const FilterEstimate& step(double time_s, const Eigen::VectorXd& input,
                                     const Eigen::VectorXd& measurement) = 0;
  /// The prediction for a later time, `input` held until then, as an estimate without a measurement. The filter stays
  /// as it was.
  virtual FilterEstimate forecast(double time_s, const Eigen::VectorXd& input) = 0;
  virtual bool started() const = 0;
  virtual void restart() = 0;
  /// Remembers what it knows now, and goes back to it.
  virtual void remember() = 0;
  virtual void go_back() = 0;
  /// What it knows as a file. Throws as save_checkpoint and load_checkpoint do.
  virtual void save(const std::string& file, const std::string& identity) const = 0;
  virtual Resumed resume(const std::string& file, const std::string& identity) = 0;
};

/// The filter that the configuration asks for. `bank`: whose sizes and period it has.
struct OpenedFilter {
  Bank bank;
  FilterOptions options;
  std::unique_ptr<LiveFilter> filter;
};
/// Throws ConfigurationError for filters that are no bank: `what` is done with banks alone.
void require_bank(const Config& config, const std::string& what);
/// Which of an archive's banks the configuration asks for; of combined the first of them.
std::string tracked_bank(const Config& config);
/// How it steps: competitors run as evaluate runs them.
FilterOptions tracked_options(const Config& config);
/// Throws ConfigurationError when the columns named are more or fewer than the bank has.
void check_columns(const Config& config, const Bank& bank, const std::string& archive);
/// Throws as load_bank does, and ConfigurationError for what the filter cannot do.
OpenedFilter open_filter(const std::string& archive, const Config& config);

}  // namespace modebank::app
