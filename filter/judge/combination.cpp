#include "filter/judge/combination.hpp"

#include <algorithm>
#include <cmath>
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

/// Combines the forecasts of one horizon of one run.
class CombinedHorizon {
 public:
  CombinedHorizon(const std::vector<const HorizonEvaluation*>& members, std::size_t horizon, std::vector<double> start)
      : members_(members), horizon_(horizon), start_(std::move(start)), said_(members.size()) {}

  /// Fills in the forecasts of all samples. The forecast of sample k has the weights of sample k - h.
  void fill(CombinedForecasts& out) {
    const Index h = members_.front()->horizons[horizon_], N = members_.front()->log_density.cols();
    ForecastWeights now(start_, h);
    Eigen::MatrixXd known(std::ssize(said_), N);  // weights after each sample
    std::vector<double> weights(said_.size());
    for (Index k = 0; k < N; ++k) {
      add_sample(k);
      if (!std::isnan(said_.front())) {
        Eigen::VectorXd::Map(weights.data(), known.rows()) = known.col(k - h);
        combine(k, weights, out);
      }
      now.observe(said_);
      known.col(k) = Eigen::VectorXd::Map(now.weights().data(), known.rows());
    }
  }

 private:
  const std::vector<const HorizonEvaluation*>& members_;
  std::size_t horizon_;
  std::vector<double> start_, said_;

  void add_sample(Index k) {
    for (std::size_t i = 0; i < members_.size(); ++i)
      said_[i] = members_[i]->log_density(static_cast<Index>(horizon_), k);
  }

  void combine(Index k, const std::vector<double>& weights, CombinedForecasts& out) const {
    out.predictions.log_density(static_cast<Index>(horizon_), k) = ForecastWeights::mixed_log_density(weights, said_);
    const std::vector<double> spoken = ForecastWeights::spoken_weights(weights, said_);
    auto error = out.predictions.error[horizon_].col(k);
    error.setZero();
    auto pit = out.predictions.pit[horizon_].col(k);
    pit.setZero();
    for (std::size_t i = 0; i < members_.size(); ++i) {
      out.weight[horizon_](static_cast<Index>(i), k) = spoken[i];
      if (!(spoken[i] > 0.0)) continue;
      error += spoken[i] * members_[i]->error[horizon_].col(k);
      pit += spoken[i] * members_[i]->pit[horizon_].col(k);
    }
  }
};

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
    CombinedHorizon(members, h, start.empty() ? std::vector<double>(members.size(), 1.0) : start.at(h)).fill(out);
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

ForecastTables::Weights ForecastTables::sum_weights(const std::vector<Eigen::MatrixXd>& weight) {
  const auto horizons = static_cast<Index>(weight.size());
  Weights total{Eigen::MatrixXd::Zero(weight.empty() ? 0 : weight.front().rows(), horizons),
                Eigen::VectorXd::Zero(horizons)};
  for (Index h = 0; h < horizons; ++h)
    for (const auto column : weight[static_cast<std::size_t>(h)].colwise()) {
      if (std::isnan(column(0))) continue;
      total.sum.col(h) += column;
      total.samples(h) += 1.0;
    }
  return total;
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
  weights_.at(run) = sum_weights(combined.weight);
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

/// Sums over the runs of a role that have been added so far.
ForecastTables::Weights ForecastTables::weights_of(Role role) const {
  Weights total;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const Weights& run = weights_[i];
    if (runs_[i].role != role || run.samples.size() == 0) continue;
    if (total.samples.size() == 0) {
      total = run;
    } else {
      total.sum += run.sum;
      total.samples += run.samples;
    }
  }
  return total;
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
  const auto any =
      std::find_if(weights_.begin(), weights_.end(), [](const Weights& w) { return w.samples.size() > 0; });
  if (any == weights_.end()) return rows;
  const std::vector<HorizonSums>& horizons = sums_.back()[static_cast<std::size_t>(any - weights_.begin())];
  for (const Role role : {Role::train, Role::test}) {
    const Weights total = weights_of(role);
    for (Index h = 0; h < total.samples.size(); ++h)
      for (std::size_t f = 0; f < filters_.size(); ++f)
        rows.push_back({role, horizons[static_cast<std::size_t>(h)].horizon, filters_[f],
                        total.sum(static_cast<Index>(f), h) / total.samples(h),
                        start_.empty() ? not_a_number : start_.at(static_cast<std::size_t>(h)).at(f)});
  }
  return rows;
}

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
