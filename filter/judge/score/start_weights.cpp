// Starting weights of combined forecasts.
#include <cmath>

#include "filter/judge/score/combination.hpp"
#include "modebank/filter/forecast_weights.hpp"

namespace modebank {

using Eigen::Index;
using filter::ForecastWeights;

std::vector<double> start_weights(const std::vector<CombinationRow>& rows, Index horizon,
                                  const std::vector<std::string>& filters) {
  std::vector<double> weights;
  for (const std::string& filter : filters)
    for (const CombinationRow& row : rows) {
      if (row.role != Role::train || row.horizon != horizon || row.filter != filter) continue;
      weights.push_back(row.start);
      break;
    }
  if (weights.size() != filters.size()) return {};
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
  if (!(sum > 0.0)) weights.assign(weights.size(), 1.0);  // no training sample was scored
  return weights;
}

std::vector<LeftOutRow> left_out_rows(const std::vector<std::string>& filters,
                                      const std::vector<std::vector<HorizonEvaluation>>& forecasts) {
  std::vector<LeftOutRow> rows;
  if (forecasts.empty() || forecasts.front().empty()) return rows;
  const std::vector<HorizonEvaluation>& of_bank = forecasts.front();
  const auto row_of = [](const std::string& filter, const HorizonSums& sums, double start) {
    const double N = sums.samples > 0 ? static_cast<double>(sums.samples) : not_a_number;
    return LeftOutRow{filter, sums.horizon, sums.samples, sums.log_density / N, (sums.squared_error / N).sqrt(), start};
  };
  std::vector<std::vector<double>> start;
  for (std::size_t h = 0; h < of_bank.front().horizons.size(); ++h) {
    std::vector<Eigen::MatrixXd> densities;
    for (std::size_t r = 0; r < of_bank.size(); ++r) {
      densities.emplace_back(std::ssize(filters), of_bank[r].log_density.cols());
      for (std::size_t f = 0; f < filters.size(); ++f)
        densities.back().row(static_cast<Index>(f)) = forecasts[f][r].log_density.row(static_cast<Index>(h));
    }
    start.push_back(stacked_weights(densities));
  }
  const auto add = [&](const std::string& filter, const std::vector<HorizonEvaluation>& runs, std::ptrdiff_t f) {
    std::vector<HorizonSums> sums = sum_horizons(runs.front());
    for (std::size_t r = 1; r < runs.size(); ++r) {
      const std::vector<HorizonSums> of_run = sum_horizons(runs[r]);
      for (std::size_t h = 0; h < sums.size(); ++h) sums[h] += of_run[h];
    }
    for (std::size_t h = 0; h < sums.size(); ++h)
      rows.push_back(row_of(filter, sums[h], f < 0 ? not_a_number : start[h][static_cast<std::size_t>(f)]));
  };
  for (std::size_t f = 0; f < filters.size(); ++f) add(filters[f], forecasts[f], static_cast<std::ptrdiff_t>(f));
  if (filters.size() < 2) return rows;
  std::vector<HorizonEvaluation> combined;
  for (std::size_t r = 0; r < of_bank.size(); ++r) {
    std::vector<const HorizonEvaluation*> members;
    for (const std::vector<HorizonEvaluation>& one : forecasts) members.push_back(&one[r]);
    combined.push_back(combine_forecasts(members, start).predictions);
  }
  add(combined_name, combined, -1);
  return rows;
}

std::vector<std::vector<double>> start_weights(const std::vector<LeftOutRow>& rows, const std::vector<Index>& horizons,
                                               const std::vector<std::string>& filters) {
  std::vector<std::vector<double>> weights;
  for (const Index horizon : horizons) {
    std::vector<double>& of_horizon = weights.emplace_back();
    for (const std::string& filter : filters)
      for (const LeftOutRow& row : rows)
        if (row.filter == filter && row.horizon == horizon && row.start > 0.0) of_horizon.push_back(row.start);
    if (of_horizon.size() != filters.size()) return {};
  }
  return weights;
}

std::vector<double> stacked_weights(const std::vector<Eigen::MatrixXd>& log_densities) {
  Index samples = 0;
  for (const Eigen::MatrixXd& run : log_densities) samples += run.cols();
  const Index every = 1 + samples / enough_densities;
  std::vector<std::vector<double>> of_filters(log_densities.empty() ? 0 : log_densities.front().rows());
  for (const Eigen::MatrixXd& run : log_densities)
    for (Index k = 0; k < run.cols(); k += every) {
      if (std::isnan(run(0, k))) continue;  // combined forecasts have the samples of the first filter
      for (Index f = 0; f < run.rows(); ++f) of_filters[static_cast<std::size_t>(f)].push_back(run(f, k));
    }
  return ForecastWeights::stacked(of_filters);
}

}  // namespace modebank
