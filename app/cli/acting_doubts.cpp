#include "app/cli/acting_doubts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>
#include <utility>

#include "app/cli/log/joined_inputs.hpp"
#include "app/config/option_text.hpp"
#include "app/text/structure_text.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "ident/data/stretch.hpp"
#include "ident/lag/linear_stage.hpp"
#include "ident/lag/structure_search.hpp"
#include "io/import/import.hpp"

namespace modebank::app {
namespace {

constexpr double least_nats_per_state = 6.0;
constexpr Index most_samples = 20'000;

/// The beginning of the training runs.
Recording beginning_of(const Recording& recording) {
  Recording part{recording.states, recording.inputs, {}, recording.quantum};
  Index left = most_samples;
  for (const Trajectory& run : recording.runs)
    if (const Index samples = std::min(left, run.samples()); run.role == Role::train && samples > 0) {
      part.runs.push_back(stretch(run, 0, samples));
      left -= samples;
    }
  return part;
}

/// The row of the single linear model that the search chose; null if nothing was searched.
const StructureScore* searched_row(const Archive& archive) {
  if (!archive.structure || !archive.recording || !archive.structure->remark.empty()) return nullptr;
  return of_linear(*archive.structure);
}

ArmaxStructure searched_structure(const Archive& archive, const StructureScore& row) {
  return armax_of(row, *archive.structure, archive.recording->input_count(),
                  row.differences || !archive.baseline || archive.baseline->structure.intercept);
}

/// A fit of one structure; empty where the runs are too short for it.
std::optional<ArmaxFit> fitted(const Recording& recording, const ArmaxStructure& structure) {
  LinearStage stage = find_linear_stage(recording, {.only = structure});
  return stage.candidates.empty() ? std::nullopt : std::optional(std::move(stage.candidates.front()));
}

/// Gain of log score of another structure or recording on the same rows [nats]; -inf where one could not be fitted.
double gain_of(const std::optional<ArmaxFit>& other, const std::optional<ArmaxFit>& base) {
  if (!other || !base || other->rows != base->rows) return -INFINITY;
  return other->left_out.of_part.sum() - base->left_out.of_part.sum();
}

std::string same_sample_doubt(const Recording& recording, const ArmaxStructure& structure) {
  const std::vector<Index> least = least_delays(recording);
  std::vector<std::string> gains;
  std::optional<ArmaxFit> base;
  for (std::size_t i = 0; i < least.size(); ++i) {
    if (least[i] == 0 || structure.delays[i] == 0) continue;
    if (!base) base = fitted(recording, structure);
    ArmaxStructure at_once = structure;
    at_once.delays[i] = 0;
    if (const double gain = gain_of(fitted(recording, at_once), base);
        gain >= least_nats_per_state * static_cast<double>(recording.state_count()))
      gains.push_back(fmt::format("{} of the same sample would gain {:.0f} nats", recording.inputs[i].name, gain));
  }
  if (gains.empty()) return "";
  return fmt::format(
      "{}: it acts within one sample, or a controller computes it from {}, which the log cannot tell apart; the models "
      "take its earlier samples alone (window.input_delay)",
      fmt::join(gains, ", "), fmt::join(names_of(recording.states), ", "));
}

/// Not of held inputs: where those act at once, a delay of 1 makes sensor noise of their jumps.
std::string noise_doubt(const Recording& recording, const ArmaxStructure& structure, const Eigen::VectorXd& rmse) {
  if (std::ranges::equal(structure.delays, least_delays(recording), std::greater_equal())) return "";
  LinearStageOptions options;
  options.intercept = structure.order.intercept;
  const LinearStage stage = find_linear_stage(recording, options);
  if (stage.candidates.empty()) return "";
  const Bank later = bank_of(recording, stage.fit(), std::nullopt);
  for (Index i = 0; i < std::min(rmse.size(), later.R.rows()); ++i) {
    const double noise = std::sqrt(later.R(i, i));
    const double error = later.R_standard_error.rows() > i ? later.R_standard_error(i, i) / (2.0 * noise) : 0.0;
    if (const Channel& state = recording.states[static_cast<std::size_t>(i)]; rmse(i) < noise - 2.0 * error)
      return fmt::format(
          "with a delay of 0, {0} is predicted within {1:.2g}{3}, which is below its sensor noise of {2:.2g}{3} (the "
          "best linear model of delay 1 or more): an input is computed from {0}, so set window.input_delay = 1 or more",
          state.name, rmse(i), noise, state.unit.empty() ? "" : " " + state.unit);
  }
  return "";
}

struct Tried {
  double gain;
  Index moved;  ///< the state whose errors shrink most
};

/// The largest gain by the last input over a few delays.
Tried try_last_input(Recording recording, const ArmaxStructure& structure) {
  std::vector<std::optional<ArmaxFit>> fits;
  for (const Index delay : {1, 2, 4, 8}) {
    ArmaxStructure with = structure;
    with.delays.push_back(delay);
    fits.push_back(fitted(recording, with));
  }
  remove_input(recording, recording.input_count() - 1);
  const std::optional<ArmaxFit> base = fitted(recording, structure);
  Tried best{-INFINITY, 0};
  for (const auto& fit : fits)
    if (const double gain = gain_of(fit, base); gain > best.gain) {
      best.gain = gain;
      base->S.diagonal().cwiseQuotient(fit->S.diagonal()).maxCoeff(&best.moved);
    }
  return best;
}

}  // namespace

std::vector<std::string> delay_doubts(const Archive& archive) {
  const StructureScore* const row = searched_row(archive);
  if (!row || archive.recording->inputs.empty()) return {};
  const ArmaxStructure structure = searched_structure(archive, *row);
  const Recording recording = beginning_of(*archive.recording);
  std::vector<std::string> doubts{same_sample_doubt(recording, structure),
                                  noise_doubt(recording, structure, row->rmse)};
  std::erase(doubts, "");
  return doubts;
}

std::vector<std::string> left_channel_doubts(const Archive& archive, const Config& config,
                                             std::vector<ChannelLeft> left) {
  constexpr std::size_t most_tried = 8, most_named = 3;
  const StructureScore* const row = searched_row(archive);
  std::erase_if(left, [](const ChannelLeft& channel) { return channel.points == 0; });
  if (!row || left.empty()) return {};
  const ArmaxStructure structure = searched_structure(archive, *row);
  std::vector<std::pair<double, std::string>> found;
  for (std::size_t c = 0; c < std::min(most_tried, left.size()); ++c) {
    Config with = config;
    with.data.input.push_back(left[c].name);
    if (with.data.input_unit.size() > 1) with.data.input_unit.emplace_back();
    DataOptions data = data_options_of(with);
    data.lag_auto = false;
    Recording recording;
    try {
      recording = beginning_of(import_data(data).recording);
    } catch (const std::runtime_error&) {
      continue;  // a channel of another table, or one with missing values
    }
    if (recording.input_count() != std::ssize(structure.delays) + 1) continue;
    const std::vector<std::string> states = names_of(recording.states);
    if (const auto [gain, moved] = try_last_input(std::move(recording), structure);
        gain >= least_nats_per_state * static_cast<double>(states.size()))
      found.emplace_back(gain, fmt::format("{} also moves {} ({:.0f} nats): data.input = {}; if it is measured beside "
                                           "it, data.state",
                                           left[c].name, states[static_cast<std::size_t>(moved)], gain,
                                           format_value(with.data.input)));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> doubts;
  for (std::size_t i = 0; i < std::min(most_named, found.size()); ++i) doubts.push_back(found[i].second);
  return doubts;
}

}  // namespace modebank::app
