#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/stored_bank.hpp"
#include "io/hdf5/links.hpp"
#include "io/hdf5/sizes.hpp"

namespace modebank {

/// Stored forms (io/archive/bank/stored_bank.hpp) of what stands in an archive beside banks.

StoredChannels store_channels(const std::vector<Channel>& channels);
std::vector<Channel> restore_channels(const StoredChannels& stored);

/// Windows by the name of their run.
struct StoredWindows {
  std::vector<std::string> run;                          ///< M
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> start;  ///< M
};
StoredWindows store_windows(const std::vector<Window>& windows, const std::vector<Trajectory>& runs);
/// Every window must lie within its run.
std::vector<Window> restore_windows(const StoredWindows& stored, const std::vector<Trajectory>& runs, Index length);

/// restore_structure for windows, whose arrays have one entry per measured state; p is that of the motion model if
/// there is one.
void restore_window_structure(WindowFits& fits, Index states, Index parameters);
/// No count of the audit exceeds that of the windows.
void check_audit(const WindowFits& fits);

/// The components' covariances, F*F x K.
Eigen::MatrixXd store_covariances(const std::vector<Eigen::MatrixXd>& covariances);
std::vector<Eigen::MatrixXd> restore_covariances(const Eigen::MatrixXd& stored, Index features);

// What arrays that were read one by one must be together; each throws DataError.
void check_mixture(const MixtureResult& result);

/// The members of these sizes, which may be missing, are all there or none is.
void check_together(const char* what, std::initializer_list<Eigen::Index> sizes);
/// Tables speak of runs, labels and modes that are there and of filters that are known.
void check_score_names(const Archive& archive);
/// Groups of these names are there once each.
void check_different(const std::string& what, const std::vector<std::string>& names);

/// How many samples all runs have together, which no count of them exceeds.
void set_samples(Sizes& sizes, const Recording& recording);
/// Extents that a filter's evaluation has from its bank and from the data, as far as the archive holds them.
Sizes sizes_of_filter(const Archive& archive, const std::string& filter);
/// Of the tables over all filters.
Sizes sizes_of_evaluation(const Archive& archive, const Recording& recording);

/// Whether a link to another file is one of a study's to its trials: /trials/KEY to the root of trials/KEY.h5.
bool is_trial_link(const std::string& place, const std::string& file, const std::string& object);
/// The links to other files that what was read may have: runs' archives have none.
hdf5::LinkAllowed links_of(const Archive& archive);

/// Throws DataError for a label of the run that none of so many names belongs to; -1: nothing is known.
void check_label_positions(const Eigen::VectorXi& label, std::size_t names, const std::string& run);

}  // namespace modebank
