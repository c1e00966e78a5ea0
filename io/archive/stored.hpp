#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/stored_bank.hpp"
#include "io/archive/groups/sizes.hpp"

namespace modebank {

/// Stored forms of an archive's parts other than banks. Those of banks are in io/archive/bank/stored_bank.hpp.

StoredChannels store_channels(const std::vector<Channel>& channels);
std::vector<Channel> restore_channels(const StoredChannels& stored);

/// A row of /data/runs.
struct RunRow {
  std::string name;
  Role role = Role::train;
  Index first = 0;  ///< row of the run's first sample in all arrays over samples
  Index samples = 0;
  double lag_s = 0.0;
  std::int64_t time_origin_ns = 0;
  std::string file;
};
std::vector<RunRow> store_runs(const std::vector<Trajectory>& runs);
/// Makes runs without their samples. Throws if there is a gap between the rows of two runs.
std::vector<Trajectory> restore_runs(const std::vector<RunRow>& rows);
std::vector<hdf5::Rows> rows_of(const std::vector<RunRow>& rows);
/// The rows of runs that are in memory, one run after another.
std::vector<hdf5::Rows> rows_of(const std::vector<Trajectory>& runs);

/// A run's labels; -1 if unknown. Throws DataError for an index without a name.
Eigen::VectorXi restore_label(const Eigen::VectorXi& stored, const RunRow& run, std::size_t names);

/// Windows, each with the name of its run.
struct StoredWindows {
  std::vector<std::string> run;                          ///< M
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> start;  ///< M
};
StoredWindows store_windows(const std::vector<Window>& windows, const std::vector<Trajectory>& runs);
/// Throws if a window lies partly or fully outside its run.
std::vector<Window> restore_windows(const StoredWindows& stored, const std::vector<Trajectory>& runs, Index length);

/// Like restore_structure, but for windows. Their arrays have one entry per measured state. With a motion model, p is
/// the number of its parameters.
void restore_window_structure(WindowFits& fits, Index states, Index parameters);

/// The covariances of the components, F*F x K.
Eigen::MatrixXd store_covariances(const std::vector<Eigen::MatrixXd>& covariances);
std::vector<Eigen::MatrixXd> restore_covariances(const Eigen::MatrixXd& stored, Index features);

// The functions below compare arrays that were read one by one. Each throws DataError if they disagree.
void check_mixture(const MixtureResult& result);

/// Throws unless all members of these sizes exist, or none of them.
void check_together(const char* what, std::initializer_list<Eigen::Index> sizes);
/// Throws unless all modes named in the tables exist.
void check_modes(const Archive& archive);
/// Throws unless all runs, labels and filters named in the tables exist.
void check_score_names(const Archive& archive);
/// Throws DataError if a name occurs twice.
void check_different(const std::string& what, const std::vector<std::string>& names);

/// Extents of a filter's evaluation. They come from the filter's bank and the data, if the archive contains these.
Sizes sizes_of_filter(const Archive& archive, const std::string& filter);
/// Extents of the tables over all filters.
Sizes sizes_of_evaluation(const Archive& archive, const Recording& recording);

/// Residual tests as two tables. One has a row per model and run; the other has a row per model, run and lag.
struct ResidualRunRow {
  std::string model, run;
  Index samples = 0;
  double level = 0.0, autocorrelation_band = 0.0;
  Index lags = 0;                          ///< T
  Eigen::VectorXd ljung_box_p;             ///< n
  Eigen::VectorXd cross_correlation_band;  ///< n*m, row by row
};
struct ResidualLagRow {
  std::string model, run;
  Index lag = 0;
  Eigen::VectorXd autocorrelation;    ///< n
  Eigen::VectorXd cross_correlation;  ///< n*m, row by row
};
/// Makes the rows of both tables, one model after the other.
void store_residual_runs(const std::vector<ResidualTestSet>& sets, const std::vector<Trajectory>& runs,
                         const std::function<void(const std::vector<ResidualRunRow>&)>& append);
void store_residual_lags(const std::vector<ResidualTestSet>& sets, const std::vector<Trajectory>& runs,
                         const std::function<void(const std::vector<ResidualLagRow>&)>& append);
/// Adds rows to both tables one by one. The rows of runs must come first.
class RestoredResiduals {
 public:
  explicit RestoredResiduals(const Recording& recording);
  void take(const ResidualRunRow& row);
  void take(const ResidualLagRow& row);
  /// Throws DataError if a table lacks a row.
  std::vector<ResidualTestSet> sets();

 private:
  ResidualTests& tests_of(const std::string& model, const std::string& run);

  Index n_, m_;
  std::map<std::string, std::size_t> runs_;
  std::vector<ResidualTestSet> sets_;
  Index missing_lags_ = 0;
};

}  // namespace modebank
