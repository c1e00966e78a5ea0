#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <utility>

#include "filter/step/bank_filter.hpp"

namespace modebank {

/// A running filter of any kind: the filter of a bank, or several combined filters.
class AnyFilter {
 public:
  virtual ~AnyFilter() = default;
  /// As BankFilter::step.
  virtual const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                                     const Eigen::Ref<const Eigen::VectorXd>& measurement) = 0;
  virtual bool started() const = 0;
  virtual void restart() = 0;
  /// Saves the present state, and restores it.
  virtual void remember() = 0;
  virtual void go_back() = 0;

 protected:
  AnyFilter() = default;
  AnyFilter(const AnyFilter&) = default;
  AnyFilter& operator=(const AnyFilter&) = default;
};

class OneFilter final : public AnyFilter {
 public:
  explicit OneFilter(BankFilter filter) : filter_(std::move(filter)) {}
  const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                             const Eigen::Ref<const Eigen::VectorXd>& measurement) override {
    return filter_.step(time_s, input, measurement);
  }
  bool started() const override { return filter_.started(); }
  void restart() override { filter_.restart(); }
  void remember() override { remembered_ = filter_.snapshot(); }
  void go_back() override { filter_.restore(*remembered_); }

 private:
  BankFilter filter_;
  std::optional<FilterSnapshot> remembered_;
};

inline std::unique_ptr<AnyFilter> any_filter(const Bank& bank, const FilterOptions& options) {
  return std::make_unique<OneFilter>(BankFilter(bank, options));
}

}  // namespace modebank
