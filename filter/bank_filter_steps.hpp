#pragma once

#include <memory>

#include "filter/bank_filter.hpp"
#include "filter/sample_feed.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

/// The steps behind their sizes.
struct BankFilterSteps {
  FilterEstimate estimate;
  bool started = false;
  SampleFeed feed;

  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  BankFilterSteps(const Bank& bank, const FilterOptions& options);
  virtual ~BankFilterSteps() = default;
  BankFilterSteps(const BankFilterSteps&) = delete;
  BankFilterSteps& operator=(const BankFilterSteps&) = delete;
  virtual void start() = 0;
  virtual void wait() = 0;
  virtual void step(const Vector& measurement) = 0;
  virtual void save(FilterSnapshot& snapshot) const = 0;
  virtual void restore(const FilterSnapshot& snapshot) = 0;

  /// Nothing is said yet about this sample.
  void clear_estimate() {
    FilterEstimate& e = estimate;
    e.prediction.setConstant(not_a_number);
    e.innovation_covariance.setConstant(not_a_number);
    e.spread_share = not_a_number;
    e.steps = 0;
    clear_scores();
  }
  void clear_scores() {
    estimate.innovation.setConstant(not_a_number);
    estimate.pit.setConstant(not_a_number);
    estimate.nis = estimate.log_density = not_a_number;
  }
};

/// Those of any bank and variant.
std::unique_ptr<BankFilterSteps> make_general_steps(const Bank& bank, const FilterOptions& options);
/// Those by vector kernels; requires VectorImm::can_step(bank, options).
std::unique_ptr<BankFilterSteps> make_vector_steps(const Bank& bank, const FilterOptions& options);

/// Throws std::invalid_argument unless the snapshot is one of a filter of n states and K modes.
void check_snapshot(const FilterSnapshot& snapshot, Eigen::Index n, Eigen::Index K);

}  // namespace modebank
