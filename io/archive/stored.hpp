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

/// Stored forms (io/archive/bank/stored_bank.hpp) of an archive's parts other than banks.

StoredChannels store_channels(const std::vector<Channel>& channels);
std::vector<Channel> restore_channels(const StoredChannels& stored);

/// A row of /data/runs.
struct RunRow {
  std::string name;
  Role role = Role::train;
  Index first = 0;  ///< index of the run's first sample in all arrays over samples
  Index samples = 0;
  double lag_s = 0.0;
  std::int64_t time_origin_ns = 0;
  std::string file;
};
std::vector<RunRow> store_runs(const std::vector<Trajectory>& runs);
/// Runs without their samples. Throws if the rows do not follow each other without a gap.
std::vector<Trajectory> restore_runs(const std::vector<RunRow>& rows);
std::vector<hdf5::Rows> rows_of(const std::vector<RunRow>& rows);
/// Rows of runs in memory, one run after another.
std::vector<hdf5::Rows> rows_of(const std::vector<Trajectory>& runs);

/// A run's labels; -1 if unknown. Throws DataError for an index outside the names.
Eigen::VectorXi restore_label(const Eigen::VectorXi& stored, const RunRow& run, std::size_t names);

/// Windows, with the name of their run.
struct StoredWindows {
  std::vector<std::string> run;                          ///< M
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> start;  ///< M
};
StoredWindows store_windows(const std::vector<Window>& windows, const std::vector<Trajectory>& runs);
/// Throws if a window is not inside its run.
std::vector<Window> restore_windows(const StoredWindows& stored, const std::vector<Trajectory>& runs, Index length);

/// restore_structure for windows, whose arrays have one entry per measured state. If there is a motion model, p is the
/// number of its parameters.
void restore_window_structure(WindowFits& fits, Index states, Index parameters);
/// Throws if a count of the audit exceeds the number of windows.
void check_audit(const WindowFits& fits);

/// The components' covariances, F*F x K.
Eigen::MatrixXd store_covariances(const std::vector<Eigen::MatrixXd>& covariances);
std::vector<Eigen::MatrixXd> restore_covariances(const Eigen::MatrixXd& stored, Index features);

// These functions compare arrays that were read one by one; each throws DataError.
void check_mixture(const MixtureResult& result);

/// Throws unless either all members of these sizes exist or none.
void check_together(const char* what, std::initializer_list<Eigen::Index> sizes);
/// Checks that tables name existing modes.
void check_modes(const Archive& archive);
/// Checks that tables name existing runs and labels and known filters.
void check_score_names(const Archive& archive);
/// Checks that each of these groups exists exactly once.
void check_different(const std::string& what, const std::vector<std::string>& names);

/// Binds the number of samples of all runs, the bound of every count of samples.
void set_samples(Sizes& sizes, const Recording& recording);
/// Extents of a filter's evaluation, from its bank and the data, if the archive has them.
Sizes sizes_of_filter(const Archive& archive, const std::string& filter);
/// Extents of the tables over all filters.
Sizes sizes_of_evaluation(const Archive& archive, const Recording& recording);

/// Residual tests as two tables: one row per model and run, and one row per lag of each of these.
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
/// Adds the rows of both tables one by one; rows of runs come first.
class RestoredResiduals {
 public:
  explicit RestoredResiduals(const Recording& recording);
  void take(const ResidualRunRow& row);
  void take(const ResidualLagRow& row);
  /// Throws DataError if either table lacks a row.
  std::vector<ResidualTestSet> sets();

 private:
  ResidualTests& tests_of(const std::string& model, const std::string& run);

  Index n_, m_;
  std::map<std::string, std::size_t> runs_;
  std::vector<ResidualTestSet> sets_;
  Index missing_lags_ = 0;
};

}  // namespace modebank
