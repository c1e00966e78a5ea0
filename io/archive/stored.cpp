#include "io/archive/stored.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <type_traits>

#include "io/files/run_names.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

StoredChannels store_channels(const std::vector<Channel>& channels) {
  StoredChannels stored;
  for (const Channel& channel : channels) {
    stored.names.push_back(channel.name);
    stored.units.push_back(channel.unit);
    if (channel.averaged) stored.averaged.push_back(channel.name);
  }
  return stored;
}

std::vector<Channel> restore_channels(const StoredChannels& stored) {
  if (stored.names.size() != stored.units.size())
    throw DataError("the numbers of channel names and units must be equal");
  std::vector<Channel> channels;
  for (std::size_t i = 0; i < stored.names.size(); ++i) channels.push_back({stored.names[i], stored.units[i]});
  for (const std::string& name : stored.averaged) {
    const auto is_it = [&](const Channel& channel) { return channel.name == name; };
    const auto channel = std::find_if(channels.begin(), channels.end(), is_it);
    if (channel == channels.end()) throw DataError("averaged channel " + name + " is not among the channels");
    channel->averaged = true;
  }
  return channels;
}

std::vector<hdf5::Rows> rows_of(const std::vector<Trajectory>& runs) {
  std::vector<hdf5::Rows> rows;
  hsize_t first = 0;
  for (const Trajectory& run : runs) {
    rows.push_back({first, static_cast<hsize_t>(run.samples())});
    first = rows.back().end();
  }
  return rows;
}

std::vector<RunRow> store_runs(const std::vector<Trajectory>& runs) {
  std::vector<RunRow> stored;
  const std::vector<hdf5::Rows> rows = rows_of(runs);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Trajectory& run = runs[i];
    stored.push_back(
        {run.run, run.role, static_cast<Index>(rows[i].first), run.samples(), run.lag_s, run.time_origin_ns, run.file});
  }
  return stored;
}

std::vector<Trajectory> restore_runs(const std::vector<RunRow>& rows) {
  std::vector<Trajectory> runs;
  Index first = 0;
  for (const RunRow& row : rows) {
    if (row.first != first || row.samples < 0 || row.samples > std::numeric_limits<Index>::max() - first)
      throw DataError("run '" + row.name + "' has rows " + std::to_string(row.first) + " and " +
                      std::to_string(row.samples) + " on, must follow row " + std::to_string(first - 1));
    first += row.samples;
    Trajectory& run = runs.emplace_back();
    run.run = row.name;
    run.role = row.role;
    run.lag_s = row.lag_s;
    run.time_origin_ns = row.time_origin_ns;
    run.file = row.file;
  }
  check_run_names(run_names(runs));
  return runs;
}

std::vector<hdf5::Rows> rows_of(const std::vector<RunRow>& rows) {
  std::vector<hdf5::Rows> result;
  for (const RunRow& row : rows) result.push_back({static_cast<hsize_t>(row.first), static_cast<hsize_t>(row.samples)});
  return result;
}

Eigen::VectorXi restore_label(const Eigen::VectorXi& stored, const RunRow& run, std::size_t names) {
  if (stored.size() == 0) return Eigen::VectorXi::Constant(run.samples, -1);
  if (stored.minCoeff() >= -1 && stored.maxCoeff() < static_cast<int>(names)) return stored;
  throw DataError("labels of run '" + run.name + "' reach beyond the " + std::to_string(names) + " label_names");
}

StoredWindows store_windows(const std::vector<Window>& windows, const std::vector<Trajectory>& runs) {
  StoredWindows stored;
  stored.start.resize(static_cast<Index>(windows.size()));
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (windows[i].run < 0 || static_cast<std::size_t>(windows[i].run) >= runs.size())
      throw std::invalid_argument("window " + std::to_string(i) + " lies in run " + std::to_string(windows[i].run) +
                                  " of " + std::to_string(runs.size()));
    stored.run.push_back(runs[static_cast<std::size_t>(windows[i].run)].run);
    stored.start(static_cast<Index>(i)) = windows[i].start;
  }
  return stored;
}

std::vector<Window> restore_windows(const StoredWindows& stored, const std::vector<Trajectory>& runs, Index length) {
  std::map<std::string, Index> positions;
  for (std::size_t i = 0; i < runs.size(); ++i) positions.emplace(runs[i].run, static_cast<Index>(i));
  std::vector<Window> windows;
  for (std::size_t i = 0; i < stored.run.size(); ++i) {
    const auto found = positions.find(stored.run[i]);
    if (found == positions.end()) throw DataError("a window names the unknown run '" + stored.run[i] + "'");
    const Index start = stored.start(static_cast<Index>(i));
    const Index transitions = runs[static_cast<std::size_t>(found->second)].transitions();
    if (start < 0 || length < 1 || length > transitions || start > transitions - length)
      throw DataError("window " + std::to_string(i) + " reaches beyond run '" + stored.run[i] + "'");
    windows.push_back({found->second, start});
  }
  return windows;
}

void restore_window_structure(WindowFits& fits, Index states, Index parameters) {
  check_lags(fits.structure, states * std::max(Index{1}, fits.structure.state_lags));
  fits.structure.states = states;
  if (fits.parameter_count() != parameters) parameters_do_not_fit(parameters, states);
}

Eigen::MatrixXd store_covariances(const std::vector<Eigen::MatrixXd>& covariances) {
  const Index features = covariances.empty() ? 0 : covariances.front().rows();
  return side_by_side(
      covariances.size(), features, features,
      "covariance", [&](std::size_t k) -> const auto& { return covariances[k]; });
}

std::vector<Eigen::MatrixXd> restore_covariances(const Eigen::MatrixXd& stored, Index features) {
  std::vector<Eigen::MatrixXd> covariances;
  for (Index k = 0; k < stored.cols(); ++k) covariances.push_back(one_of(stored, k, features, features));
  return covariances;
}

void check_together(const char* what, std::initializer_list<Eigen::Index> sizes) {
  const auto missing = std::count(sizes.begin(), sizes.end(), 0);
  if (missing != 0 && missing != static_cast<std::ptrdiff_t>(sizes.size()))
    throw DataError(std::string("one of ") + what + " is missing");
}

void check_mixture(const MixtureResult& result) {
  constexpr double sum_tolerance = 1e-6;
  const GaussianMixture& mixture = result.mixture;
  const double sum = mixture.weights.sum() + mixture.noise.weight;
  if (mixture.components() > 0 && !(std::abs(sum - 1.0) <= sum_tolerance))
    throw DataError("the weights sum to " + std::to_string(sum) + ", must be 1");
  check_count("feature_names", result.feature_names, mixture.features());
  if (mixture.noise.lower.size() != mixture.noise.upper.size()) throw DataError("the box of the noise has one corner");
  if ((mixture.noise.lower.array() > mixture.noise.upper.array()).any())
    throw DataError("the lower corner of the noise's box lies above the upper one");
}

namespace {

constexpr std::array filters{"bank", "baseline", "noise_only", "one_motion", "drifting", "nonlinear", combined_name};

bool is_filter(const std::string& name) { return std::find(filters.begin(), filters.end(), name) != filters.end(); }

/// Checks rows that name a filter and a run.
template <class Row>
void check_rows(const std::vector<Row>& rows, const std::set<std::string>& runs, const std::string& table) {
  for (const Row& row : rows) {
    if (!is_filter(row.filter)) throw DataError(table + " names the unknown filter '" + row.filter + "'");
    if constexpr (requires { row.run; })
      if (!runs.empty() && row.run != "*" && !runs.contains(row.run))
        throw DataError(table + " names the unknown run '" + row.run + "'");
  }
}

/// Returns nullopt for an unreadable bank, so that verification continues without the bank.
std::optional<Bank> whole_bank(const Archive& archive, const std::string& filter) try {
  return archive.bank_of(filter);
} catch (const std::invalid_argument&) {
  return std::nullopt;
}

/// Checks rows that name a filter and one of its modes.
template <class Row>
void check_modes(const std::vector<Row>& rows, const Archive& archive, const std::string& table) {
  std::map<std::string, Index> modes;
  for (const char* filter : filters)
    if (const auto bank = whole_bank(archive, filter)) modes[filter] = bank->mode_count();
  for (const Row& row : rows)
    if (const auto found = modes.find(row.filter); found != modes.end() && row.mode >= found->second)
      throw DataError(table + " names mode " + std::to_string(row.mode) + " of the " + std::to_string(found->second) +
                      " of " + row.filter);
}

void check_labels(const Archive& archive) {
  if (!archive.labels) return;
  const std::set<std::string> known(archive.labels->names.begin(), archive.labels->names.end());
  for (const ConfusionRow& row : archive.confusion)
    if (!known.contains(row.label)) throw DataError("confusion names the unknown label '" + row.label + "'");
}

/// Checks the names of competitors in a finding. A name may be empty.
void check_competitors(const Finding& finding) {
  const auto known = [](const std::string& name, bool may_be_empty) {
    if ((name.empty() && may_be_empty) || (is_filter(name) && name != combined_name)) return;
    throw DataError("evidence names the unknown filter '" + name + "'");
  };
  known(finding.best_competitor, true);
  known(finding.better_description, true);
  for (const PairedGain& gain : finding.gains) known(gain.competitor, false);
  for (const BetterMean& mean : finding.better_means) known(mean.competitor, false);
}

void check_finding(const Archive& archive) {
  if (!archive.finding) return;
  check_competitors(*archive.finding);
  const auto compare = [](Index said, Index there, bool fits, const char* of) {
    if (!fits)
      throw DataError("evidence is about " + std::to_string(said) + " " + of + ", there are " + std::to_string(there));
  };
  const Index runs = archive.recording ? std::ssize(archive.recording->runs) : archive.finding->runs;
  const Index modes = archive.bank ? archive.bank->mode_count() : archive.finding->modes;
  compare(archive.finding->runs, runs, archive.finding->runs <= runs, "runs");
  compare(archive.finding->modes, modes, archive.finding->modes == modes, "modes");
}

}  // namespace

void check_different(const std::string& what, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (const std::string& name : names)
    if (!seen.insert(name).second) throw DataError(what + " names '" + name + "' twice");
}

void check_modes(const Archive& archive) {
  check_modes(archive.diagnostics, archive, "diagnostics");
  check_modes(archive.confusion, archive, "confusion");
}

void check_score_names(const Archive& archive) {
  std::set<std::string> runs;
  if (archive.recording)
    for (const Trajectory& run : archive.recording->runs) runs.insert(run.run);
  check_rows(archive.evaluations, {}, "filters");
  check_rows(archive.summary, runs, "summary");
  check_rows(archive.horizons, runs, "horizon");
  check_rows(archive.combination, runs, "combination");
  check_rows(archive.left_out, runs, "left_out");
  check_rows(archive.free_runs, runs, "free_run");
  check_rows(archive.diagnostics, runs, "diagnostics");
  check_rows(archive.confusion, runs, "confusion");
  check_labels(archive);
  check_finding(archive);
}

Sizes sizes_of_filter(const Archive& archive, const std::string& filter) {
  Sizes sizes;
  if (archive.recording) sizes.set("n_y", archive.recording->states.size());
  const std::optional<Bank> bank = whole_bank(archive, filter);
  if (!bank || bank->modes.empty()) return sizes;
  sizes.set("K", bank->modes.size());
  return sizes;
}

Sizes sizes_of_evaluation(const Archive& archive, const Recording& recording) {
  Sizes sizes;
  if (!recording.states.empty()) sizes.set("n_y", recording.states.size());
  std::size_t modes = 0;
  for (const char* filter : filters)
    if (const auto bank = whole_bank(archive, filter)) modes = std::max(modes, bank->modes.size());
  if (modes > 0) sizes.set("K", modes);
  return sizes;
}

}  // namespace modebank
