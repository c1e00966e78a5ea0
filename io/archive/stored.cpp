#include "io/archive/stored.hpp"

#include <map>
#include <stdexcept>

#include "modebank/base/error.hpp"

namespace modebank {

StoredChannels store_channels(const std::vector<Channel>& channels) {
  StoredChannels stored;
  for (const Channel& channel : channels) {
    stored.names.push_back(channel.name);
    stored.units.push_back(channel.unit);
  }
  return stored;
}

std::vector<Channel> restore_channels(const StoredChannels& stored) {
  if (stored.names.size() != stored.units.size()) throw DataError("as many channel names as units are needed");
  std::vector<Channel> channels;
  for (std::size_t i = 0; i < stored.names.size(); ++i) channels.push_back({stored.names[i], stored.units[i]});
  return channels;
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

void check_label_positions(const Eigen::VectorXi& label, std::size_t names, const std::string& run) {
  if (label.size() == 0 || (label.minCoeff() >= -1 && label.maxCoeff() < static_cast<int>(names))) return;
  throw DataError("labels of run '" + run + "' reach beyond the " + std::to_string(names) + " label_names");
}

}  // namespace modebank
