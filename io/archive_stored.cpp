#include "io/archive_stored.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "ident/error.hpp"

namespace modebank {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Lays one matrix per mode into the columns of a `rows * cols` x K array, row-major within each column.
template <class Get>
Eigen::MatrixXd side_by_side(std::size_t count, Index rows, Index cols, const char* what, Get get) {
  Eigen::MatrixXd result(rows * cols, static_cast<Index>(count));
  for (std::size_t k = 0; k < count; ++k) {
    const auto& matrix = get(k);
    if (matrix.rows() != rows || matrix.cols() != cols)
      throw std::invalid_argument(std::string(what) + " of mode " + std::to_string(k) + " is " +
                                  std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) + ", must be " +
                                  std::to_string(rows) + " x " + std::to_string(cols));
    Eigen::Map<RowMajor>(result.col(static_cast<Index>(k)).data(), rows, cols) = matrix;
  }
  return result;
}

Eigen::MatrixXd one_of(const Eigen::MatrixXd& columns, Index k, Index rows, Index cols) {
  return Eigen::Map<const RowMajor>(columns.col(k).data(), rows, cols);
}

}  // namespace

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

StoredChannels store_model_parameters(const std::vector<ModelParameter>& parameters) {
  StoredChannels stored;
  for (const ModelParameter& parameter : parameters) {
    stored.names.push_back(parameter.name);
    stored.units.push_back(parameter.unit);
  }
  return stored;
}

std::vector<ModelParameter> restore_model_parameters(const StoredChannels& stored) {
  std::vector<ModelParameter> parameters;
  for (const Channel& channel : restore_channels(stored)) parameters.push_back({channel.name, channel.unit});
  return parameters;
}

namespace {

void check_lags(const LinearStructure& s, Index dimension) {
  if (dimension < 1 || s.inputs < 0 || s.state_lags < 1 || s.input_lags < 1 || s.input_delay < 0 ||
      dimension % s.state_lags != 0)
    throw DataError(std::to_string(dimension) + " states, " + std::to_string(s.inputs) + " inputs and lags of " +
                    std::to_string(s.state_lags) + ", " + std::to_string(s.input_lags) + ", " +
                    std::to_string(s.input_delay) + " make no model");
}

[[noreturn]] void parameters_do_not_fit(Index parameters, Index states) {
  throw DataError(std::to_string(parameters) + " parameters do not fit " + std::to_string(states) + " states");
}

}  // namespace

LinearStructure restore_structure(LinearStructure structure, Index dimension, Index parameters) {
  check_lags(structure, dimension);
  structure.states = dimension / structure.state_lags;
  if (structure.parameters() != parameters) parameters_do_not_fit(parameters, structure.states);
  return structure;
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

StoredBank store_bank(const Bank& bank) {
  const LinearStructure& s = bank.structure;
  const Index n = s.dimension(), p = s.parameters();
  const auto columns = [&](Index rows, Index cols, const char* what, auto get) {
    return side_by_side(
        bank.modes.size(), rows, cols, what, [&](std::size_t k) -> const auto& { return get(bank.modes[k]); });
  };
  const auto absent = [&](auto get) {
    return std::all_of(bank.modes.begin(), bank.modes.end(), [&](const Mode& mode) { return get(mode).size() == 0; });
  };
  StoredBank stored;
  stored.model = bank.model;
  stored.structure = s;
  if (!bank.motion_parameters.empty()) {
    const Index p_motion = std::ssize(bank.motion_parameters);
    stored.motion_parameters = columns(
        p_motion, 1, "motion parameters", [](const Mode& mode) -> const auto& { return mode.motion_theta; });
    stored.motion_standard_error = columns(
        p_motion, 1, "motion standard error",
        [](const Mode& mode) -> const auto& { return mode.motion_standard_error; });
  }
  stored.c = columns(
      n, 1, "c", [](const Mode& mode) -> const auto& { return mode.model.c; });
  stored.A = columns(
      n, n, "A", [](const Mode& mode) -> const auto& { return mode.model.A; });
  stored.B = columns(
      n, s.acting_inputs(), "B", [](const Mode& mode) -> const auto& { return mode.model.B; });
  stored.Q = columns(
      n, n, "Q", [](const Mode& mode) -> const auto& { return mode.Q; });
  const auto spread = [](const Mode& mode) -> const auto& { return mode.spread; };
  if (!absent(spread)) stored.spread = columns(p, p, "parameter covariance", spread);
  const auto standard_error = [](const Mode& mode) -> const auto& { return mode.standard_error; };
  if (!absent(standard_error)) stored.standard_error = columns(p, 1, "parameter standard error", standard_error);
  const auto Q_error = [](const Mode& mode) -> const auto& { return mode.Q_standard_error; };
  if (!absent(Q_error)) stored.Q_standard_error = columns(n, n, "Q standard error", Q_error);
  stored.R_standard_error = bank.R_standard_error.transpose();
  stored.transition_standard_error = bank.transition_standard_error.transpose();
  stored.parameters.resize(p, bank.mode_count());
  stored.weight.resize(bank.mode_count());
  for (Index k = 0; k < bank.mode_count(); ++k) {
    stored.parameters.col(k) = bank.theta(k);
    stored.weight(k) = bank.modes[static_cast<std::size_t>(k)].weight;
  }
  stored.C = bank.C.transpose();
  stored.R = bank.R.transpose();
  stored.transition = bank.transition.matrix().transpose();
  stored.initial_probability = bank.initial_probability;
  return stored;
}

Bank restore_bank(const StoredBank& stored, Bank bank) {
  const LinearStructure& s = stored.structure;
  const Index n = s.dimension(), p = s.parameters();
  if (stored.B.rows() != n * s.acting_inputs())
    throw DataError("B has " + std::to_string(stored.B.rows() / n) + " inputs, the parameters " +
                    std::to_string(s.acting_inputs()));
  if (stored.motion_parameters.rows() != std::ssize(bank.motion_parameters) ||
      stored.motion_standard_error.rows() != std::ssize(bank.motion_parameters))
    throw DataError("the motion parameters are not as many as their names");
  bank.model = stored.model;
  bank.structure = s;
  bank.modes.clear();
  for (Index k = 0; k < stored.weight.size(); ++k) {
    Mode mode;
    mode.model = {one_of(stored.A, k, n, n), one_of(stored.B, k, n, s.acting_inputs()), stored.c.col(k)};
    mode.Q = one_of(stored.Q, k, n, n);
    if (stored.spread.size() > 0) mode.spread = one_of(stored.spread, k, p, p);
    if (stored.standard_error.size() > 0) mode.standard_error = stored.standard_error.col(k);
    if (stored.Q_standard_error.size() > 0) mode.Q_standard_error = one_of(stored.Q_standard_error, k, n, n);
    mode.weight = stored.weight(k);
    if (stored.motion_parameters.size() > 0) {
      mode.motion_theta = stored.motion_parameters.col(k);
      mode.motion_standard_error = stored.motion_standard_error.col(k);
    }
    bank.modes.push_back(std::move(mode));
  }
  bank.C = stored.C.transpose();
  bank.R = stored.R.transpose();
  bank.transition = TransitionMatrix(stored.transition.transpose());
  bank.initial_probability = stored.initial_probability;
  bank.R_standard_error = stored.R_standard_error.transpose();
  bank.transition_standard_error = stored.transition_standard_error.transpose();
  check_sizes(bank);
  return bank;
}

}  // namespace modebank
