#include "filter/judge/horizon.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "filter/judge/forecast.hpp"
#include "filter/judge/statistics.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// One sample ahead by running noise, the prediction is the filter's own: its levels have different means.
void take_from_filter(const Bank& bank, const Trajectory& run, HorizonEvaluation& out) {
  const RunInstants instants(bank, run);
  DriftingFilter filter(bank);
  Eigen::VectorXd weight;
  for (Index t = 0; t < instants.count(); ++t) {
    const double log_density = follow(instants, t, run, filter);
    const Index k = instants.instants[static_cast<std::size_t>(t)].sample;
    if (k < 0 || std::isnan(out.log_density(0, k))) continue;
    filter.weigh_levels(0, weight);
    for (Index i = 0; i < out.error[0].rows(); ++i) out.pit[0](i, k) = filter.probability(i, 0.0, weight);
    out.error[0].col(k) = filter.innovation();
    out.log_density(0, k) = log_density;
  }
}

}  // namespace

HorizonEvaluation empty_horizons(std::vector<Index> horizons, Index n_y, Index samples) {
  std::sort(horizons.begin(), horizons.end());
  horizons.erase(std::unique(horizons.begin(), horizons.end()), horizons.end());
  if (!horizons.empty() && horizons.front() < 1) throw std::invalid_argument("horizons must be at least 1");
  HorizonEvaluation out;
  out.error.assign(horizons.size(), Eigen::MatrixXd::Constant(n_y, samples, not_a_number));
  out.pit = out.error;
  out.log_density.setConstant(std::ssize(horizons), samples, not_a_number);
  out.horizons = std::move(horizons);
  return out;
}

HorizonEvaluation evaluate_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                    std::vector<Index> horizons) {
  const std::unique_ptr<ForecastingFilter> filter = forecasting_filter(bank, run, options);
  HorizonEvaluation out = empty_horizons(std::move(horizons), bank.C.rows(), run.samples());
  if (out.horizons.empty()) return out;
  filter->predict_run(out.horizons, [&](Forecast& forecast, std::size_t h, Index k) {
    const auto y = run.state.col(k);
    out.log_density(static_cast<Index>(h), k) = forecast.observe(y, out.error[h].col(k));
    for (Index i = 0; i < y.size(); ++i) out.pit[h](i, k) = forecast.probability(i, y(i));
  });
  if (!bank.running_noise.empty() && out.horizons.front() == 1) take_from_filter(bank, run, out);
  return out;
}

std::vector<HorizonSums> sum_horizons(const HorizonEvaluation& run) {
  std::vector<HorizonSums> sums;
  for (std::size_t h = 0; h < run.horizons.size(); ++h) {
    const Eigen::MatrixXd& error = run.error[h];
    HorizonSums& sum = sums.emplace_back(HorizonSums{run.horizons[h], 0, 0.0, Eigen::ArrayXd::Zero(error.rows())});
    for (Index k = 0; k < error.cols(); ++k) {
      const double value = run.log_density(static_cast<Index>(h), k);
      if (std::isnan(value)) continue;
      ++sum.samples;
      sum.log_density += value;
      sum.squared_error += error.col(k).array().square();
      sum.inside += static_cast<double>(((run.pit[h].col(k).array() - 0.5).abs() <= 0.475).count());
    }
  }
  return sums;
}

void pool(const std::vector<HorizonSums>& run, std::vector<HorizonSums>& all) {
  if (all.empty()) {
    all = run;
    return;
  }
  for (std::size_t h = 0; h < all.size(); ++h) {
    const HorizonSums& of = run.at(h);
    all[h].samples += of.samples;
    all[h].log_density += of.log_density;
    all[h].squared_error += of.squared_error;
    all[h].inside += of.inside;
  }
}

std::vector<HorizonRow> summarize_horizons(const std::string& filter, const std::vector<Trajectory>& runs,
                                           const std::vector<std::vector<HorizonSums>>& sums) {
  std::vector<HorizonRow> rows;
  const auto add_row = [&](Role role, const std::string& run, const HorizonSums& of) {
    const double N = of.samples > 0 ? static_cast<double>(of.samples) : not_a_number;
    const double inside = of.inside / (N * static_cast<double>(of.squared_error.size()));
    rows.push_back(
        {filter, role, run, of.horizon, of.samples, of.log_density / N, (of.squared_error / N).sqrt(), inside});
  };
  using Sums = std::vector<HorizonSums>;
  for (const Role role : {Role::train, Role::test})
    sum_runs<Sums>(
        runs, role, [&](std::size_t i, Sums& all) { pool(sums.at(i), all); },
        [&](const Sums& all, const std::string& run) {
          for (const HorizonSums& of : all) add_row(role, run, of);
        });
  return rows;
}

}  // namespace modebank
