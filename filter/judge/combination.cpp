#include "filter/judge/combination.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "modebank/filter/forecast_weights.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using filter::ForecastWeights;

void check_members(const std::vector<const HorizonEvaluation*>& members) {
  if (members.empty()) throw std::invalid_argument("no forecasts to combine");
  for (const HorizonEvaluation* member : members)
    if (member->horizons != members.front()->horizons ||
        member->log_density.cols() != members.front()->log_density.cols())
      throw std::invalid_argument("combined forecasts must have the same samples and horizons");
}

/// Combines the forecasts of one horizon of one run. The forecast of sample k has the weights of sample k - h.
void combine_horizon(const std::vector<const HorizonEvaluation*>& members, std::size_t at, ForecastWeights now,
                     CombinedForecasts& out) {
  const Index h = members.front()->horizons[at], N = members.front()->log_density.cols(), F = std::ssize(members);
  std::vector<double> said(members.size()), weights(members.size());
  Eigen::MatrixXd known(F, N);  // weights after each sample
  for (Index k = 0; k < N; ++k) {
    for (std::size_t i = 0; i < members.size(); ++i) said[i] = members[i]->log_density(static_cast<Index>(at), k);
    if (!std::isnan(said.front())) {
      Eigen::VectorXd::Map(weights.data(), F) = known.col(k - h);
      out.predictions.log_density(static_cast<Index>(at), k) = ForecastWeights::mixed_log_density(weights, said);
      const std::vector<double> spoken = ForecastWeights::spoken_weights(weights, said);
      out.weight[at].col(k) = Eigen::VectorXd::Map(spoken.data(), F);
      auto error = out.predictions.error[at].col(k), pit = out.predictions.pit[at].col(k);
      error.setZero();
      pit.setZero();
      for (std::size_t i = 0; i < members.size(); ++i) {
        if (!(spoken[i] > 0.0)) continue;
        error += spoken[i] * members[i]->error[at].col(k);
        pit += spoken[i] * members[i]->pit[at].col(k);
      }
    }
    now.observe(said);
    known.col(k) = Eigen::VectorXd::Map(now.weights().data(), F);
  }
}

}  // namespace

CombinedForecasts combine_forecasts(const std::vector<const HorizonEvaluation*>& members,
                                    const std::vector<std::vector<double>>& start) {
  check_members(members);
  const HorizonEvaluation& first = *members.front();
  const Index N = first.log_density.cols();
  CombinedForecasts out;
  out.predictions = empty_horizons(first.horizons, first.error.empty() ? Index{0} : first.error.front().rows(), N);
  out.weight.assign(first.horizons.size(), Eigen::MatrixXd::Constant(std::ssize(members), N, not_a_number));
  for (std::size_t h = 0; h < first.horizons.size(); ++h)
    combine_horizon(members, h,
                    {start.empty() ? std::vector<double>(members.size(), 1.0) : start.at(h), first.horizons[h]}, out);
  return out;
}

ForecastTables::ForecastTables(std::vector<std::string> filters, const std::vector<Trajectory>& runs,
                               std::vector<std::vector<double>> start)
    : filters_(std::move(filters)),
      runs_(runs),
      sums_(filters_.size() + 1, std::vector<std::vector<HorizonSums>>(runs.size())),
      weights_(runs.size()),
      densities_(runs.size()),
      start_(std::move(start)) {
  Index samples = 0;
  for (const Trajectory& run : runs) samples += run.role == Role::train ? run.samples() : 0;
  every_ = 1 + samples / enough_densities;
}

void ForecastTables::add(std::size_t run, const std::vector<HorizonEvaluation>& of_filters) {
  std::vector<const HorizonEvaluation*> members;
  for (std::size_t f = 0; f < of_filters.size(); ++f) {
    sums_.at(f).at(run) = sum_horizons(of_filters[f]);
    members.push_back(&of_filters[f]);
  }
  if (!combines()) return;
  const CombinedForecasts combined = combine_forecasts(members, start_);
  sums_.back().at(run) = sum_horizons(combined.predictions);
  Eigen::MatrixXd& weight = weights_.at(run);
  weight.setZero(std::ssize(members), std::ssize(combined.weight));
  for (Index h = 0; h < weight.cols(); ++h)
    for (const auto column : combined.weight[static_cast<std::size_t>(h)].colwise())
      if (!std::isnan(column(0))) weight.col(h) += column;
  if (runs_[run].role != Role::train || !start_.empty()) return;
  for (std::size_t h = 0; h < combined.weight.size(); ++h) {
    const Index samples = of_filters.front().log_density.cols();
    Eigen::MatrixXd& kept = densities_.at(run).emplace_back(std::ssize(members), (samples + every_ - 1) / every_);
    for (std::size_t f = 0; f < members.size(); ++f)
      for (Index k = 0; k < kept.cols(); ++k)
        kept(static_cast<Index>(f), k) = members[f]->log_density(static_cast<Index>(h), k * every_);
  }
}

std::vector<HorizonRow> ForecastTables::horizons() const {
  std::vector<HorizonRow> rows;
  for (std::size_t f = 0; f < filters_.size() + (combines() ? 1 : 0); ++f)
    for (HorizonRow& row : summarize_horizons(f < filters_.size() ? filters_[f] : combined_name, runs_, sums_[f]))
      rows.push_back(std::move(row));
  return rows;
}

void ForecastTables::start_as_trained() {
  if (!start_.empty() || !combines()) return;
  std::size_t horizons = 0;
  for (const std::vector<Eigen::MatrixXd>& run : densities_) horizons = std::max(horizons, run.size());
  for (std::size_t h = 0; h < horizons; ++h) {
    std::vector<Eigen::MatrixXd> of_runs;
    for (const std::vector<Eigen::MatrixXd>& run : densities_)
      if (!run.empty()) of_runs.push_back(run[h]);
    start_.push_back(stacked_weights(of_runs));
  }
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
        rows.push_back({role, sums[h].horizon, filters_[f],
                        weight(static_cast<Index>(f), static_cast<Index>(h)) / static_cast<double>(sums[h].samples),
                        start_.empty() ? not_a_number : start_.at(h).at(f)});
  }
  return rows;
}

namespace {

/// The starting weights of `filters` in the rows that count; empty unless each filter has one.
template <class Row, class Counts>
std::vector<double> starts_in(const std::vector<Row>& rows, const std::vector<std::string>& filters, Counts counts) {
  std::vector<double> starts;
  for (const std::string& filter : filters) {
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.filter == filter && counts(r); });
    if (row == rows.end()) return {};
    starts.push_back(row->start);
  }
  return starts;
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
  const auto tables_of = [&](const std::vector<std::vector<double>>& start) {
    ForecastTables tables(filters, runs, start);
    for (std::size_t r = 0; r < runs.size(); ++r) {
      std::vector<HorizonEvaluation> of_filters;
      for (const std::vector<HorizonEvaluation>& of_runs : forecasts) of_filters.push_back(of_runs[r]);
      tables.add(r, of_filters);
    }
    tables.start_as_trained();
    return tables;
  };
  const std::vector<std::vector<double>> start = tables_of({}).start();
  for (const HorizonRow& row : tables_of(start).horizons()) {
    if (row.run != "*") continue;
    rows.push_back({row.filter, row.horizon, row.samples, row.log_score, row.rmse});
    const std::size_t f = (rows.size() - 1) / forecasts.front().front().horizons.size(),
                      h = (rows.size() - 1) % forecasts.front().front().horizons.size();
    if (f < filters.size()) rows.back().start = start.empty() ? 1.0 : start[h][f];
  }
  return rows;
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
