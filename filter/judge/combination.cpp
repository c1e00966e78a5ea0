#include "filter/judge/combination.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "modebank/filter/forecast_weights.hpp"

namespace modebank {

using Eigen::Index;
using filter::ForecastWeights;

CombinedForecasts combine_forecasts(const std::vector<HorizonEvaluation>& members,
                                    const std::vector<std::vector<double>>& start) {
  const HorizonEvaluation& first = members.front();
  const Index N = first.log_density.cols(), F = std::ssize(members);
  CombinedForecasts out;
  out.predictions = empty_horizons(first.horizons, first.error.empty() ? Index{0} : first.error.front().rows(), N);
  out.weight.assign(first.horizons.size(), Eigen::MatrixXd::Constant(F, N, not_a_number));
  std::vector<double> said(members.size()), weights(members.size());
  for (std::size_t h = 0; h < first.horizons.size(); ++h) {
    ForecastWeights now(start.empty() ? std::vector<double>(members.size(), 1.0) : start.at(h), first.horizons[h]);
    Eigen::MatrixXd known(F, N);  // weights after each sample
    for (Index k = 0; k < N; ++k) {
      for (std::size_t i = 0; i < members.size(); ++i) said[i] = members[i].log_density(h, k);
      if (!std::isnan(said.front())) {
        Eigen::VectorXd::Map(weights.data(), F) = known.col(k - first.horizons[h]);  // those at the origin
        out.predictions.log_density(h, k) = ForecastWeights::mixed_log_density(weights, said);
        const std::vector<double> spoken = ForecastWeights::spoken_weights(weights, said);
        out.weight[h].col(k) = Eigen::VectorXd::Map(spoken.data(), F);
        auto error = out.predictions.error[h].col(k), pit = out.predictions.pit[h].col(k);
        error.setZero();
        pit.setZero();
        for (std::size_t i = 0; i < members.size(); ++i) {
          if (!(spoken[i] > 0.0)) continue;
          error += spoken[i] * members[i].error[h].col(k);
          pit += spoken[i] * members[i].pit[h].col(k);
        }
      }
      now.observe(said);
      known.col(k) = Eigen::VectorXd::Map(now.weights().data(), F);
    }
  }
  return out;
}

ForecastTables::ForecastTables(std::vector<std::string> filters, const std::vector<Trajectory>& runs,
                               std::vector<std::vector<double>> start)
    : filters_(std::move(filters)),
      runs_(runs),
      sums_(filters_.size() + (filters_.size() > 1 ? 1 : 0), std::vector<std::vector<HorizonSums>>(runs.size())),
      weights_(runs.size()),
      densities_(runs.size()),
      start_(std::move(start)) {
  constexpr Index enough_densities = 20000;
  Index samples = 0;
  for (const Trajectory& run : runs) samples += run.role == Role::train ? run.samples() : 0;
  every_ = 1 + samples / enough_densities;
}

void ForecastTables::add(std::size_t run, const std::vector<HorizonEvaluation>& of_filters) {
  for (std::size_t f = 0; f < filters_.size(); ++f) sums_[f].at(run) = sum_horizons(of_filters[f]);
  if (filters_.size() < 2) return;
  const CombinedForecasts combined = combine_forecasts(of_filters, start_);
  const Index F = std::ssize(of_filters), samples = combined.predictions.log_density.cols();
  sums_.back()[run] = sum_horizons(combined.predictions);
  weights_[run].setZero(F, std::ssize(combined.weight));
  for (std::size_t h = 0; h < combined.weight.size(); ++h) {
    const Eigen::MatrixXd& weight = combined.weight[h];
    weights_[run].col(h) = weight.array().isNaN().select(0.0, weight.array()).rowwise().sum();
    if (runs_[run].role != Role::train || !start_.empty()) continue;
    std::vector<std::vector<double>>& kept = densities_[run].emplace_back(F);
    for (Index k = 0; k < samples; k += every_)
      for (Index f = 0; f < F && !std::isnan(of_filters.front().log_density(h, k)); ++f)
        kept[f].push_back(of_filters[f].log_density(h, k));
  }
}

std::vector<HorizonRow> ForecastTables::horizons() const {
  std::vector<HorizonRow> rows;
  for (std::size_t f = 0; f < sums_.size(); ++f)
    for (HorizonRow& row : summarize_horizons(f < filters_.size() ? filters_[f] : combined_name, runs_, sums_[f]))
      rows.push_back(std::move(row));
  return rows;
}

void ForecastTables::start_as_trained() {
  if (!start_.empty()) return;
  std::vector<std::vector<std::vector<double>>> of_horizons;
  for (const auto& run : densities_) {
    of_horizons.resize(std::max(of_horizons.size(), run.size()), std::vector<std::vector<double>>(filters_.size()));
    for (std::size_t h = 0; h < run.size(); ++h)
      for (std::size_t f = 0; f < filters_.size(); ++f)
        of_horizons[h][f].insert(of_horizons[h][f].end(), run[h][f].begin(), run[h][f].end());
  }
  for (const auto& of_filters : of_horizons) start_.push_back(ForecastWeights::stacked(of_filters));
  densities_.assign(densities_.size(), {});
}

std::vector<CombinationRow> ForecastTables::combination() const {
  std::vector<CombinationRow> rows;
  for (const Role role : {Role::train, Role::test}) {
    std::vector<HorizonSums> sums;
    Eigen::MatrixXd weight;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (runs_[i].role != role || weights_[i].size() == 0) continue;
      weight = sums.empty() ? weights_[i] : (weight + weights_[i]).eval();
      pool(sums_.back()[i], sums);
    }
    for (std::size_t h = 0; h < sums.size(); ++h)
      for (std::size_t f = 0; f < filters_.size(); ++f)
        rows.push_back({role, sums[h].horizon, filters_[f], weight(f, h) / static_cast<double>(sums[h].samples),
                        start_.empty() ? not_a_number : start_.at(h).at(f)});
  }
  return rows;
}

namespace {

/// The starting weights of `filters` in the rows that count; empty unless each filter has one.
template <class Row, class Counts>
std::vector<double> starts_in(const std::vector<Row>& rows, const std::vector<std::string>& filters, Counts counts) {
  std::vector<double> starts;
  for (const std::string& filter : filters)
    for (const Row& row : rows)
      if (row.filter == filter && counts(row)) starts.push_back(row.start);
  return starts.size() == filters.size() ? starts : std::vector<double>();
}

}  // namespace

std::vector<double> start_weights(const std::vector<CombinationRow>& rows, Index horizon,
                                  const std::vector<std::string>& filters) {
  std::vector<double> weights = starts_in(
      rows, filters, [&](const CombinationRow& row) { return row.role == Role::train && row.horizon == horizon; });
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum > 0.0)) weights.assign(weights.size(), 1.0);  // no training sample was scored
  return weights;
}

std::vector<std::vector<double>> start_weights(const std::vector<LeftOutRow>& rows, const std::vector<Index>& horizons,
                                               const std::vector<std::string>& filters) {
  std::vector<std::vector<double>> weights;
  for (const Index horizon : horizons) {
    weights.push_back(
        starts_in(rows, filters, [&](const LeftOutRow& row) { return row.horizon == horizon && row.start > 0.0; }));
    if (weights.back().empty()) return {};
  }
  return weights;
}

std::vector<LeftOutRow> left_out_rows(const std::vector<std::string>& filters,
                                      const std::vector<std::vector<HorizonEvaluation>>& forecasts) {
  std::vector<LeftOutRow> rows;
  if (forecasts.empty() || forecasts.front().empty()) return rows;
  std::vector<Trajectory> runs(forecasts.front().size());  // training runs, of which only the lengths count
  for (std::size_t r = 0; r < runs.size(); ++r) runs[r].state.resize(0, forecasts.front()[r].log_density.cols());
  ForecastTables tables(filters, runs);
  for (int pass = 0; pass < 2; ++pass) {  // the second starts with the weights of the first
    for (std::size_t r = 0; r < runs.size(); ++r) {
      std::vector<HorizonEvaluation> of_filters;
      for (const std::vector<HorizonEvaluation>& of_runs : forecasts) of_filters.push_back(of_runs[r]);
      tables.add(r, of_filters);
    }
    tables.start_as_trained();
  }
  for (const HorizonRow& row : tables.horizons())
    if (row.run == "*") rows.push_back({row.filter, row.horizon, row.samples, row.log_score, row.rmse});
  const std::size_t horizons = forecasts.front().front().horizons.size();
  for (std::size_t i = 0; i < filters.size() * horizons; ++i)
    rows[i].start = tables.start().empty() ? 1.0 : tables.start()[i % horizons][i / horizons];
  return rows;
}

}  // namespace modebank
