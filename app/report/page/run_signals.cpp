#include <fmt/format.h>

#include <map>

#include "app/report/page/prediction_band.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/series.hpp"
#include "app/report/page/unit_text.hpp"
#include "filter/judge/squared_distances.hpp"
#include "ident/base/distributions.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

/// What counts as an outlier: a true filter has one sample in a thousand so far out.
constexpr double outlier_level = 0.999;

json rows_of(PageArrays& arrays, const Eigen::MatrixXd& rows, Index finest, Bucket kind = Bucket::extremes) {
  json list = json::array();
  for (Index i = 0; i < rows.rows(); ++i) list.push_back(series(arrays, rows.row(i).transpose(), finest, kind));
  return list;
}

/// Times of the outliers and the values measured then; of very many the first.
json outliers_of(PageArrays& arrays, const RunEvaluation& evaluation, const Trajectory& run) {
  constexpr std::size_t most = 20000;
  std::vector<Index> samples = outlying_samples(evaluation, outlier_level);
  const std::size_t count = samples.size();
  samples.resize(std::min(most, count));
  json values = json::array();
  for (Index i = 0; i < run.state.rows(); ++i) {
    const Eigen::VectorXd measured = run.state(i, samples).transpose();
    values.push_back(arrays.add(measured));
  }
  const Eigen::VectorXd times = run.time_s(samples);
  return {{"count", count}, {"time", arrays.add_exact(times)}, {"values", values}};
}

json filter_signals(PageArrays& arrays, const Bank& bank, const RunEvaluation& evaluation, const Trajectory& run,
                    Index finest) {
  const PredictionBand band = prediction_band(bank, evaluation, drawn_level);
  json signals = {{"prediction", rows_of(arrays, band.center, finest)},
                  {"half_width", rows_of(arrays, band.half_width, finest)},
                  {"innovation", rows_of(arrays, evaluation.innovation, finest)},
                  {"nis", series(arrays, nis_of_all_signals(evaluation), finest)},
                  {"outliers", outliers_of(arrays, evaluation, run)},
                  {"lower", rows_of(arrays, band.center - band.half_width, finest, Bucket::lowest)},
                  {"upper", rows_of(arrays, band.center + band.half_width, finest, Bucket::highest)}};
  if (bank.mode_count() > 1)
    signals["probability"] = rows_of(arrays, evaluation.mode_probability, finest, Bucket::share);
  return signals;
}

json free_run_signals(PageArrays& arrays, const FreeRun& run, Index finest) {
  return {{"prediction", rows_of(arrays, run.mean, finest)},
          {"center", rows_of(arrays, 0.5 * (run.lower + run.upper), finest)},
          {"half_width", rows_of(arrays, 0.5 * (run.upper - run.lower), finest)},
          {"lower", rows_of(arrays, run.lower, finest, Bucket::lowest)},
          {"upper", rows_of(arrays, run.upper, finest, Bucket::highest)}};
}

json channels_of(const std::vector<Channel>& channels) {
  json list = json::array();
  for (const Channel& channel : channels) list.push_back({{"name", channel.name}, {"unit", channel.unit}});
  return list;
}

json run_signals(const Archive& archive, std::size_t i, PageArrays& arrays, const Detail& detail) {
  const Trajectory& run = archive.recording->runs[i];
  json entry = {{"name", run.run},
                {"position", i},
                {"role", name_of(run.role)},
                {"lag_s", run.lag_s},
                {"time", time_axis(arrays, run.time_s, detail.finest)},
                {"state", rows_of(arrays, run.state, detail.finest)},
                {"input", rows_of(arrays, run.input, detail.finest)},
                {"filters", json::object()}};
  if (run.truth.size() > 0) entry["truth"] = rows_of(arrays, run.truth, detail.finest);
  for (const FilterEvaluation& evaluation : archive.evaluations) {
    const std::optional<Bank> bank = archive.bank_of(evaluation.filter);
    if (!bank || i >= evaluation.runs.size()) continue;
    const Index finest = evaluation.filter == "bank" ? detail.finest : std::max(detail.finest, detail.finest_others);
    entry["filters"][evaluation.filter] = filter_signals(arrays, *bank, evaluation.runs[i], run, finest);
    if (!evaluation.free_runs.empty())
      entry["free_runs"][evaluation.filter] = free_run_signals(arrays, evaluation.free_runs[i], finest);
  }
  return entry;
}

/// What the page says of runs and samples that it does not draw one by one; empty where it draws all.
std::string detail_note(const Detail& detail, std::size_t drawn, std::size_t runs) {
  std::string text;
  if (drawn < runs)
    text = fmt::format(
        "Of {} runs {} are drawn and listed, the first of each kind; all are in the tables of all runs "
        "together. ",
        runs, drawn);
  if (detail.finest > 1)
    text += fmt::format("To keep the page small, signals are drawn by the extremes of every {} samples at the finest",
                        detail.finest);
  if (detail.finest_others > detail.finest)
    text +=
        fmt::format("{} of {} samples",
                    detail.finest == 1 ? "To keep the page small, filters other than the bank are drawn by the extremes"
                                       : ", other filters' by those",
                    detail.finest_others);
  const bool coarse = detail.finest > 1 || detail.finest_others > 1;
  return coarse ? text + " (report.size_mb)." : text;
}

}  // namespace

std::vector<std::size_t> drawn_runs(const Recording& recording) {
  constexpr std::size_t most_of_a_role = 100;  // beyond, nobody looks for a run in a page, and it takes minutes to make
  std::map<Role, std::size_t> taken;
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < recording.runs.size(); ++i)
    if (taken[recording.runs[i].role]++ < most_of_a_role) drawn.push_back(i);
  return drawn;
}

nlohmann::json runs_section(const Archive& archive, PageArrays& arrays, const Detail& detail) {
  if (!archive.recording) return nullptr;
  json runs = json::array(), names = json::array();
  const std::vector<std::size_t> drawn = drawn_runs(*archive.recording);
  for (const std::size_t i : drawn) runs.push_back(run_signals(archive, i, arrays, detail));
  for (const Trajectory& run : archive.recording->runs) names.push_back(run.run);
  constexpr double outer = 0.5 * (1.0 - drawn_level);
  const auto n_y = static_cast<double>(archive.recording->state_count());
  return {{"states", channels_of(archive.recording->states)},
          {"inputs", channels_of(archive.recording->inputs)},
          {"note", detail_note(detail, drawn.size(), names.size())},
          {"level", drawn_level},
          {"outlier_level", outlier_level},
          {"nis_bounds", {chi_square_quantile(outer, n_y), chi_square_quantile(1.0 - outer, n_y)}},
          {"names", names},
          {"runs", runs}};
}

nlohmann::json affordable_runs_section(const Archive& archive, PageArrays& arrays, std::size_t bytes) {
  constexpr Index coarser_others = 16, coarsest = Index{1} << 40;
  // Signals of noise compress to no less than this share: below it only trying tells whether they fit.
  constexpr double least_share = 0.5;
  const auto may_fit = [&](const Detail& detail) {
    PageArrays most(PageArrays::Kind::measure);
    runs_section(archive, most, detail);
    return least_share * static_cast<double>(most.bytes()) <= static_cast<double>(bytes);
  };
  for (Detail detail;; detail = {detail.finest * (detail.finest_others > 1 ? 2 : 1),
                                 detail.finest_others > 1 ? detail.finest_others * 2 : coarser_others}) {
    if (!may_fit(detail) && detail.finest < coarsest) continue;
    PageArrays with_runs = arrays;
    json section = runs_section(archive, with_runs, detail);
    if (with_runs.bytes() - arrays.bytes() > bytes && detail.finest < coarsest) continue;
    arrays = std::move(with_runs);
    return section;
  }
}

}  // namespace modebank::app::report
