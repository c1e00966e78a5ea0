#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "app/chain/judged_runs.hpp"
#include "app/report/figures/run_figures.hpp"
#include "app/report/figures/shown_groups.hpp"
#include "app/report/page/assets.hpp"
#include "app/report/page/prediction_band.hpp"
#include "app/report/page/unit_text.hpp"
#include "filter/judge/score/squared_distances.hpp"
#include "ident/base/distributions.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app::report {
namespace {

constexpr Index most_printed_samples = 2000;  // of a run, from its start: more than a column of print can show
constexpr double band_level = 0.95;

/// One run and what both filters said of it.
struct DrawnRun {
  const Archive& archive;
  const Trajectory& run;
  RunEvaluation bank;
  std::optional<RunEvaluation> baseline;
  Index samples() const { return std::min(most_printed_samples, run.samples()); }
};

std::size_t index_of_run(const Archive& archive, const std::string& name) {
  const auto& runs = archive.recording->runs;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (name.empty() ? runs[i].role == judged_role(archive) : runs[i].run == name) return i;
    names.push_back(runs[i].run);
  }
  throw ConfigurationError(fmt::format("report.run = {}: the archive's runs are {}", name, fmt::join(names, ", ")));
}

RunEvaluation what_is_drawn(const FilterEvaluation& evaluation, std::size_t run) {
  RunEvaluation drawn;
  evaluation.with_run(run, {"prediction", "innovation", "innovation_covariance", "nis", "pit", "mode_probability"},
                      [&](const RunEvaluation& said) { drawn = said; });
  return drawn;
}

Eigen::MatrixXd with_time(const DrawnRun& drawn, const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd table(drawn.samples(), rows.rows() + 1);
  table.col(0) = drawn.run.time_s.head(drawn.samples());
  table.rightCols(rows.rows()) = rows.leftCols(drawn.samples()).transpose();
  return table;
}

void set_time(const DrawnRun& drawn, Figure& figure) {
  figure.set("start", drawn.run.time_s(0));
  figure.set("end", drawn.run.time_s(drawn.samples() - 1));
}

/// Running sums of the mode probabilities, for the strip below; those of modes that are not told apart come last,
/// together.
void add_strip(const DrawnRun& drawn, Figure& figure) {
  const Eigen::MatrixXd& probability = drawn.bank.mode_probability;
  const ShownGroups modes = shown_modes(drawn.archive);
  std::vector<std::string> titles;
  for (const Index k : modes.shown) titles.push_back(fmt::format("{}", k));
  if (modes.any_others()) titles.push_back(modes.others_title());
  const auto layers = static_cast<Index>(titles.size());
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(layers + 1, probability.cols());
  for (std::size_t i = 0; i < modes.shown.size(); ++i)
    sums.row(static_cast<Index>(i) + 1) = sums.row(static_cast<Index>(i)) + probability.row(modes.shown[i]);
  if (modes.any_others())
    sums.row(layers) = sums.row(layers - 1) + probability(modes.others, Eigen::all).colwise().sum();
  std::vector<std::string> columns{"time [s]", "0"};
  for (const std::string& title : titles) columns.push_back("up to mode " + title);
  figure.set("layers", layers);
  figure.set("told_apart", static_cast<Index>(modes.shown.size()));
  figure.set("layer_title", titles);
  figure.add_block("mode probabilities, summed from the first mode on", columns, with_time(drawn, sums));
}

/// The run in words, for captions.
std::string run_words(const DrawnRun& drawn) {
  const std::string part = drawn.samples() < drawn.run.samples()
                               ? fmt::format(", its first {} of {} samples", drawn.samples(), drawn.run.samples())
                               : "";
  return fmt::format("the {} run {}{}", words_for(drawn.run.role), drawn.run.run, part);
}

std::string strip_words(const DrawnRun& drawn) {
  const ShownGroups modes = shown_modes(drawn.archive);
  return modes.any_others()
             ? fmt::format(" Bottom: probabilities of the modes, the {} most used one by one.", modes.shown.size())
             : " Bottom: probabilities of the modes.";
}

std::string state_label(const DrawnRun& drawn, Index state) {
  const Channel& channel = drawn.archive.recording->states[static_cast<std::size_t>(state)];
  return with_unit(channel.name, channel.unit);
}

/// The second and further states get a number.
std::string numbered(const std::string& name, Index state) {
  return state == 0 ? name : fmt::format("{}_{}", name, state + 1);
}

Figure estimates(const DrawnRun& drawn, Index state) {
  Figure figure(numbered("estimates", state), assets::figure_estimates());
  Eigen::MatrixXd rows(5, drawn.run.samples());
  rows.row(0) = drawn.run.state.row(state);
  rows.row(1).setConstant(std::numeric_limits<double>::quiet_NaN());
  if (drawn.baseline)
    rows.row(1) = prediction_band(*drawn.archive.baseline, *drawn.baseline, band_level).center.row(state);
  const PredictionBand band = prediction_band(*drawn.archive.bank, drawn.bank, band_level);
  rows.row(2) = band.center.row(state);
  rows.row(3) = band.center.row(state) - band.half_width.row(state);
  rows.row(4) = band.center.row(state) + band.half_width.row(state);
  set_time(drawn, figure);
  figure.set("state_label", state_label(drawn, state));
  figure.set("bank_title", bank_title(drawn.archive));
  figure.add_block("run " + drawn.run.run, {"time [s]", "measured", "baseline", "bank", "lower", "upper"},
                   with_time(drawn, rows));
  add_strip(drawn, figure);
  figure.set_caption(
      fmt::format("{} of {}: measured, and predicted one sample ahead by one Kalman filter (baseline) and "
                  "by the bank with its 95 % band.",
                  state_label(drawn, state), run_words(drawn)) +
      strip_words(drawn));
  return figure;
}

Figure nis(const DrawnRun& drawn) {
  Figure figure("nis", assets::figure_nis());
  const auto degrees = static_cast<double>(drawn.archive.bank->C.rows());
  Eigen::MatrixXd rows(2, drawn.run.samples());
  rows.row(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  if (drawn.baseline) rows.row(0) = nis_of_all_signals(*drawn.baseline);
  rows.row(1) = nis_of_all_signals(drawn.bank);
  set_time(drawn, figure);
  figure.set("lower_bound", chi_square_quantile((1 - band_level) / 2, degrees));
  figure.set("upper_bound", chi_square_quantile((1 + band_level) / 2, degrees));
  figure.set("bank_title", bank_title(drawn.archive));
  figure.add_block("NIS of run " + drawn.run.run, {"time [s]", "baseline", "bank"}, with_time(drawn, rows));
  add_strip(drawn, figure);
  figure.set_caption(fmt::format("Normalised innovation squared (NIS) on {}; grey: where 95 % of a true filter's lie.",
                                 run_words(drawn)) +
                     strip_words(drawn));
  return figure;
}

Figure prediction(const DrawnRun& drawn, Index state) {
  Figure figure(numbered("prediction", state), assets::figure_prediction());
  const PredictionBand band = prediction_band(*drawn.archive.bank, drawn.bank, band_level);
  Eigen::MatrixXd rows(4, drawn.run.samples());
  rows << drawn.run.state.row(state), band.center.row(state) - band.half_width.row(state),
      band.center.row(state) + band.half_width.row(state), drawn.run.state.row(state);
  Index outside = 0;
  for (Index k = 0; k < drawn.samples(); ++k) {
    const bool marked = rows(0, k) < rows(1, k) || rows(0, k) > rows(2, k);
    if (!marked) rows(3, k) = std::numeric_limits<double>::quiet_NaN();
    outside += marked;
  }
  const Recording& recording = *drawn.archive.recording;
  set_time(drawn, figure);
  figure.set("state_label", state_label(drawn, state));
  const std::string unit = common_unit(recording.inputs);
  figure.set("input_label", with_unit(recording.inputs.size() == 1 ? recording.inputs[0].name : "inputs", unit));
  figure.set("inputs", recording.input_count());
  figure.set("input_title", names_of(recording.inputs));
  figure.set("outside_title", fmt::format("outside ({} of {})", outside, drawn.samples()));
  figure.add_block("run " + drawn.run.run, {"time [s]", "measured", "lower", "upper", "outside"},
                   with_time(drawn, rows));
  std::vector<std::string> columns = names_of(recording.inputs);
  columns.insert(columns.begin(), "time [s]");
  figure.add_block("inputs", columns, with_time(drawn, drawn.run.input));
  figure.set_caption(
      fmt::format("Inputs and {} of {} with the 95 % band that the bank predicts one sample ahead; {} of "
                  "{} samples lie outside.",
                  state_label(drawn, state), run_words(drawn), outside, drawn.samples()));
  return figure;
}

}  // namespace

void add_time_figures(const Archive& archive, const std::string& run, FigureSet& set) {
  const FilterEvaluation* bank = evaluation_of(archive, "bank");
  if (!archive.recording || !archive.bank || !bank) {
    set.left_out.emplace_back("estimates, nis and prediction: the archive holds no evaluation of a bank");
    return;
  }
  const std::size_t i = index_of_run(archive, run);
  const FilterEvaluation* baseline = archive.baseline ? evaluation_of(archive, "baseline") : nullptr;
  DrawnRun drawn{archive, archive.recording->runs[i], what_is_drawn(*bank, i), std::nullopt};
  if (baseline) drawn.baseline = what_is_drawn(*baseline, i);
  for (Index state = 0; state < archive.recording->state_count(); ++state) {
    set.figures.push_back(estimates(drawn, state));
    set.figures.push_back(prediction(drawn, state));
  }
  set.figures.push_back(nis(drawn));
}

}  // namespace modebank::app::report
