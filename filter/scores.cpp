#include "filter/scores.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "filter/calibration.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// The two-sided 5 % region of a chi-square variable, as method section 6 counts it.
struct ChiSquareRegion {
  double lower, upper;
  explicit ChiSquareRegion(double degrees_of_freedom)
      : lower(chi_square_quantile(0.025, degrees_of_freedom)), upper(chi_square_quantile(0.975, degrees_of_freedom)) {}
};

/// Sums over scored samples of one or more runs. A sample is scored by the signals that it has.
class ScoreSums {
 public:
  explicit ScoreSums(Index measurements)
      : squared_error_(Eigen::ArrayXd::Zero(measurements)), errors_(Eigen::ArrayXd::Zero(measurements)) {
    for (Index i = 1; i <= measurements; ++i) nis_regions_.emplace_back(static_cast<double>(i));
  }

  /// Adds one run and its whiteness: Ljung-Box per component over the scored samples in order, components pooled.
  void add(const RunEvaluation& run) {
    std::vector<std::vector<double>> z(static_cast<std::size_t>(squared_error_.size()));
    for (Index k = 0; k < run.log_density.size(); ++k)
      if (!std::isnan(run.log_density(k))) add_sample(run, k, z);
    std::vector<double> p_values;
    for (const std::vector<double>& component : z) p_values.push_back(ljung_box_p(component));
    whiteness_.push_back(fisher_p(p_values));
  }

  SummaryRow row() const {
    SummaryRow row;
    row.samples = samples_;
    const double N = samples_ > 0 ? static_cast<double>(samples_) : not_a_number;
    const double components = pit_.empty() ? not_a_number : static_cast<double>(pit_.size());
    row.log_score = log_density_ / N;
    row.rmse = (squared_error_ / errors_).sqrt();
    row.nis_mean = nis_ / N;
    row.nis_above = static_cast<double>(nis_above_) / N;
    row.nis_below = static_cast<double>(nis_below_) / N;
    row.tail_above = static_cast<double>(tail_above_) / components;
    row.tail_below = static_cast<double>(tail_below_) / components;
    row.pit_distance = kolmogorov_distance(pit_);
    row.whiteness_p = fisher_p(whiteness_);
    return row;
  }

 private:
  Index samples_ = 0, nis_above_ = 0, nis_below_ = 0, tail_above_ = 0, tail_below_ = 0;
  double log_density_ = 0.0, nis_ = 0.0;
  Eigen::ArrayXd squared_error_, errors_;
  std::vector<double> pit_, whiteness_;
  std::vector<ChiSquareRegion> nis_regions_;  ///< of one signal, two, ...
  ChiSquareRegion z_region_{1.0};

  void add_sample(const RunEvaluation& run, Index k, std::vector<std::vector<double>>& z) {
    ++samples_;
    log_density_ += run.log_density(k);
    const auto there = (!run.pit.col(k).array().isNaN()).eval();
    squared_error_ += there.select(run.innovation.col(k).array().square(), 0.0);
    errors_ += there.cast<double>();
    const ChiSquareRegion& nis_region = nis_regions_[static_cast<std::size_t>(there.count() - 1)];
    nis_ += run.nis(k);
    nis_above_ += run.nis(k) > nis_region.upper;
    nis_below_ += run.nis(k) < nis_region.lower;
    for (Index i = 0; i < run.pit.rows(); ++i) {
      if (!there(i)) continue;
      const double score = normal_score(run.pit(i, k));
      tail_above_ += score * score > z_region_.upper;
      tail_below_ += score * score < z_region_.lower;
      pit_.push_back(run.pit(i, k));
      z[static_cast<std::size_t>(i)].push_back(score);
    }
  }
};

}  // namespace

std::vector<SummaryRow> summarize(const std::string& filter, const std::vector<Trajectory>& runs,
                                  const std::vector<RunEvaluation>& evaluations) {
  if (runs.size() != evaluations.size())
    throw std::invalid_argument(std::to_string(runs.size()) + " runs, but " + std::to_string(evaluations.size()) +
                                " evaluations");
  std::vector<SummaryRow> rows;
  const auto add_row = [&](const ScoreSums& sums, Role role, const std::string& run) {
    rows.push_back(sums.row());
    rows.back().filter = filter;
    rows.back().role = role;
    rows.back().run = run;
  };
  for (const Role role : {Role::train, Role::test}) {
    std::optional<ScoreSums> pooled;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (runs[i].role != role) continue;
      ScoreSums single(evaluations[i].innovation.rows());
      single.add(evaluations[i]);
      add_row(single, role, runs[i].run);
      if (!pooled) pooled.emplace(evaluations[i].innovation.rows());
      pooled->add(evaluations[i]);
    }
    if (pooled) add_row(*pooled, role, "*");
  }
  return rows;
}

}  // namespace modebank
