#include <algorithm>
#include <stdexcept>
#include <utility>

#include "ident/base/not_a_number.hpp"
#include "io/archive/stored.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// The entries of a matrix, column by column.
Eigen::VectorXd entries(const Eigen::MatrixXd& matrix) {
  return Eigen::Map<const Eigen::VectorXd>(matrix.data(), matrix.size());
}

/// HDF5 has no arrays of length 0, which systems without inputs would need.
Eigen::VectorXd at_least_one(const Eigen::VectorXd& values) {
  return values.size() > 0 ? values : Eigen::VectorXd::Constant(1, not_a_number);
}

void check_run_count(const ResidualTestSet& set, std::size_t runs) {
  if (set.runs.size() != runs)
    throw std::invalid_argument("residual tests of " + std::to_string(set.runs.size()) + " runs of " +
                                std::to_string(runs));
}

}  // namespace

void store_residual_runs(const std::vector<ResidualTestSet>& sets, const std::vector<Trajectory>& runs,
                         const std::function<void(const std::vector<ResidualRunRow>&)>& append) {
  for (const ResidualTestSet& set : sets) {
    check_run_count(set, runs.size());
    std::vector<ResidualRunRow> rows;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const ResidualTests& tests = set.runs[i];
      rows.push_back({set.model, runs[i].run, tests.samples, tests.level, tests.autocorrelation_band,
                      tests.autocorrelation.cols(), tests.ljung_box_p,
                      at_least_one(entries(tests.cross_correlation_band))});
    }
    append(rows);
  }
}

void store_residual_lags(const std::vector<ResidualTestSet>& sets, const std::vector<Trajectory>& runs,
                         const std::function<void(const std::vector<ResidualLagRow>&)>& append) {
  for (const ResidualTestSet& set : sets) {
    std::vector<ResidualLagRow> rows;
    for (std::size_t i = 0; i < runs.size(); ++i)
      for (Index lag = 0; lag < set.runs[i].autocorrelation.cols(); ++lag)
        rows.push_back({set.model, runs[i].run, lag, set.runs[i].autocorrelation.col(lag),
                        at_least_one(set.runs[i].cross_correlation.col(lag))});
    append(rows);
  }
}

RestoredResiduals::RestoredResiduals(const Recording& recording)
    : n_(recording.state_count()), m_(recording.input_count()) {
  for (std::size_t i = 0; i < recording.runs.size(); ++i) runs_.emplace(recording.runs[i].run, i);
}

ResidualTests& RestoredResiduals::tests_of(const std::string& model, const std::string& run) {
  const auto position = runs_.find(run);
  if (position == runs_.end()) throw DataError("names the unknown run '" + run + "'");
  auto set = std::find_if(sets_.rbegin(), sets_.rend(), [&](const ResidualTestSet& s) { return s.model == model; });
  if (set != sets_.rend()) return set->runs[position->second];
  sets_.push_back({model, std::vector<ResidualTests>(runs_.size())});
  return sets_.back().runs[position->second];
}

void RestoredResiduals::take(const ResidualRunRow& row) {
  constexpr Index most_lags = 1'000'000;  // upper limit, so that products of sizes do not overflow
  if (row.ljung_box_p.size() != n_ || row.cross_correlation_band.size() != std::max(Index{1}, n_ * m_) ||
      row.lags < 0 || row.lags > most_lags)
    throw DataError("the row of " + row.model + " and run '" + row.run + "' does not fit " + std::to_string(n_) +
                    " states and " + std::to_string(m_) + " inputs");
  ResidualTests& tests = tests_of(row.model, row.run);
  tests.samples = row.samples;
  tests.level = row.level;
  tests.autocorrelation_band = row.autocorrelation_band;
  tests.ljung_box_p = row.ljung_box_p;
  tests.cross_correlation_band = Eigen::Map<const Eigen::MatrixXd>(row.cross_correlation_band.data(), m_, n_);
  tests.autocorrelation.setConstant(n_, row.lags, not_a_number);
  tests.cross_correlation.setConstant(n_ * m_, row.lags, not_a_number);
  missing_lags_ += row.lags;
}

void RestoredResiduals::take(const ResidualLagRow& row) {
  ResidualTests& tests = tests_of(row.model, row.run);
  if (row.lag < 0 || row.lag >= tests.autocorrelation.cols() || row.autocorrelation.size() != n_ ||
      row.cross_correlation.size() != std::max(Index{1}, n_ * m_))
    throw DataError("lag " + std::to_string(row.lag) + " of " + row.model + " and run '" + row.run +
                    "' is not among the lags of its row in runs");
  tests.autocorrelation.col(row.lag) = row.autocorrelation;
  tests.cross_correlation.col(row.lag) = row.cross_correlation.head(n_ * m_);
  --missing_lags_;
}

std::vector<ResidualTestSet> RestoredResiduals::sets() {
  if (missing_lags_ != 0) throw DataError("lags has another number of rows than runs states");
  return std::move(sets_);
}

}  // namespace modebank
