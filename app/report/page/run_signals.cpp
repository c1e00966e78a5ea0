#include <fmt/format.h>

#include <limits>
#include <map>
#include <optional>

#include "app/report/page/prediction_band.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/series.hpp"
#include "app/report/page/unit_text.hpp"
#include "filter/judge/statistics.hpp"
#include "ident/base/distributions.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

/// probability level of outliers; if the model is right, one sample in a thousand is an outlier
constexpr double outlier_level = 0.999;

json rows_of(PageArrays& arrays, const Eigen::MatrixXd& rows, Index finest, Bucket kind = Bucket::extremes) {
  json list = json::array();
  for (Index i = 0; i < rows.rows(); ++i) list.push_back(series(arrays, rows.row(i).transpose(), finest, kind));
  return list;
}

/// Times and values of the outliers. If there are too many, only the first ones.
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

json filter_signals(PageArrays& arrays, const Bank& bank, const FilterEvaluation& evaluation, std::size_t i,
                    const Trajectory& run, Index finest) {
  json signals;
  // Evaluations of long runs may be in a file, and together too large for memory. So the filters are read one after the
  // other.
  evaluation.with_run(i, {"prediction", "innovation_covariance"}, [&](const RunEvaluation& said) {
    const PredictionBand band = prediction_band(bank, said, drawn_level);
    signals["prediction"] = rows_of(arrays, band.center, finest);
    signals["half_width"] = rows_of(arrays, band.half_width, finest);
    signals["lower"] = rows_of(arrays, band.center - band.half_width, finest, Bucket::lowest);
    signals["upper"] = rows_of(arrays, band.center + band.half_width, finest, Bucket::highest);
  });
  evaluation.with_run(i, {"innovation"}, [&](const RunEvaluation& said) {
    signals["innovation"] = rows_of(arrays, said.innovation, finest);
  });
  evaluation.with_run(i, {"nis", "pit"}, [&](const RunEvaluation& said) {
    signals["nis"] = series(arrays, nis_of_all_signals(said), finest);
    signals["outliers"] = outliers_of(arrays, said, run);
  });
  if (bank.mode_count() > 1)
    evaluation.with_run(i, {"mode_probability"}, [&](const RunEvaluation& said) {
      signals["probability"] = rows_of(arrays, said.mode_probability, finest, Bucket::share);
    });
  return signals;
}

/// Largest possible size of filter_signals without outliers [bytes].
std::size_t most_filter_bytes(const Bank& bank, Index samples, Index finest) {
  const auto n_y = static_cast<std::size_t>(bank.C.rows()), K = static_cast<std::size_t>(bank.mode_count());
  return (3 * n_y + 1) * most_series_bytes(samples, finest) +
         2 * n_y * most_series_bytes(samples, finest, Bucket::lowest) +
         (K > 1 ? K * most_series_bytes(samples, finest, Bucket::share) : 0);
}

json free_run_signals(PageArrays& arrays, const FreeRun& run, Index finest) {
  return {{"prediction", rows_of(arrays, run.mean, finest)},
          {"center", rows_of(arrays, 0.5 * (run.lower + run.upper), finest)},
          {"half_width", rows_of(arrays, 0.5 * (run.upper - run.lower), finest)},
          {"lower", rows_of(arrays, run.lower, finest, Bucket::lowest)},
          {"upper", rows_of(arrays, run.upper, finest, Bucket::highest)}};
}

std::size_t most_free_run_bytes(const Bank& bank, Index samples, Index finest) {
  const auto n_y = static_cast<std::size_t>(bank.C.rows());
  return 3 * n_y * most_series_bytes(samples, finest) + 2 * n_y * most_series_bytes(samples, finest, Bucket::lowest);
}

json channels_of(const std::vector<Channel>& channels) {
  json list = json::array();
  for (const Channel& channel : channels) list.push_back({{"name", channel.name}, {"unit", channel.unit}});
  return list;
}

/// Calls visit(evaluation, bank, finest) for each filter that the drawing of run i shows.
template <class Visit>
void for_each_filter(const Archive& archive, std::size_t i, const Detail& detail, Visit visit) {
  for (const FilterEvaluation& evaluation : archive.evaluations) {
    const std::optional<Bank> bank = archive.bank_of(evaluation.filter);
    if (!bank || i >= evaluation.runs.size()) continue;
    visit(evaluation, *bank,
          evaluation.filter == "bank" ? detail.finest : std::max(detail.finest, detail.finest_others));
  }
}

json run_signals(const Archive& archive, std::size_t i, PageArrays& arrays, const Detail& detail) {
  const Trajectory& run = archive.recording->runs[i];
  json entry = {{"name", run.run},
                {"role", name_of(run.role)},
                {"time", time_axis(arrays, run.time_s, detail.finest)},
                {"state", rows_of(arrays, run.state, detail.finest)},
                {"input", rows_of(arrays, run.input, detail.finest)},
                {"filters", json::object()}};
  if (run.truth.size() > 0) entry["truth"] = rows_of(arrays, run.truth, detail.finest);
  for_each_filter(archive, i, detail, [&](const FilterEvaluation& evaluation, const Bank& bank, Index finest) {
    entry["filters"][evaluation.filter] = filter_signals(arrays, bank, evaluation, i, run, finest);
    if (!evaluation.free_runs.empty())
      evaluation.with_free_run(i, [&](const FreeRun& free_run) {
        entry["free_runs"][evaluation.filter] = free_run_signals(arrays, free_run, finest);
      });
  });
  return entry;
}

std::size_t most_run_bytes(const Archive& archive, std::size_t i, const Detail& detail) {
  const Trajectory& run = archive.recording->runs[i];
  const auto rows = static_cast<std::size_t>(run.state.rows() + run.input.rows() + run.truth.rows());
  std::size_t bytes =
      most_time_bytes(run.time_s, detail.finest) + rows * most_series_bytes(run.samples(), detail.finest);
  for_each_filter(archive, i, detail, [&](const FilterEvaluation& evaluation, const Bank& bank, Index finest) {
    bytes += most_filter_bytes(bank, run.samples(), finest);
    if (!evaluation.free_runs.empty()) bytes += most_free_run_bytes(bank, run.samples(), finest);
  });
  return bytes;
}

/// A note that says which runs are not drawn and which samples are summarised. Empty if every run and sample is drawn.
std::string detail_note(const Detail& detail, std::size_t drawn, std::size_t runs) {
  std::string text;
  if (drawn < runs)
    text = fmt::format(
        "{1} of {0} runs are drawn and listed, the first of each kind. The tables over all runs include all of them. ",
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
  constexpr std::size_t most_of_a_role = 100;  // a page with more runs would take minutes to make
  std::map<Role, std::size_t> taken;
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < recording.runs.size(); ++i)
    if (taken[recording.runs[i].role]++ < most_of_a_role) drawn.push_back(i);
  return drawn;
}

namespace {

/// Returns nullopt if the arrays exceed the size limit.
std::optional<json> runs_within(const Archive& archive, PageArrays& arrays, const Detail& detail, std::size_t most) {
  json runs = json::array();
  const std::vector<std::size_t> drawn = drawn_runs(*archive.recording);
  for (const std::size_t i : drawn) {
    runs.push_back(run_signals(archive, i, arrays, detail));
    if (arrays.bytes() > most) return std::nullopt;
  }
  constexpr double outer = 0.5 * (1.0 - drawn_level);
  const auto n_y = static_cast<double>(archive.recording->state_count());
  return json{{"states", channels_of(archive.recording->states)},
              {"inputs", channels_of(archive.recording->inputs)},
              {"note", detail_note(detail, drawn.size(), archive.recording->runs.size())},
              {"level", drawn_level},
              {"outlier_level", outlier_level},
              {"nis_bounds", {chi_square_quantile(outer, n_y), chi_square_quantile(1.0 - outer, n_y)}},
              {"runs", runs}};
}

}  // namespace

std::size_t most_signal_bytes(const Archive& archive, const Detail& detail) {
  std::size_t bytes = 0;
  for (const std::size_t i : drawn_runs(*archive.recording)) bytes += most_run_bytes(archive, i, detail);
  return bytes;
}

nlohmann::json runs_section(const Archive& archive, PageArrays& arrays, const Detail& detail) {
  if (!archive.recording) return nullptr;
  return runs_within(archive, arrays, detail, std::numeric_limits<std::size_t>::max()).value();
}

nlohmann::json affordable_runs_section(const Archive& archive, PageArrays& arrays, std::size_t bytes) {
  constexpr Index coarser_others = 16, coarsest = Index{1} << 40;
  // Even noise compresses to this share of its size. A budget below it need not be tried.
  constexpr double least_share = 0.5;
  if (!archive.recording) return nullptr;
  for (Detail detail;; detail = {detail.finest * (detail.finest_others > 1 ? 2 : 1),
                                 detail.finest_others > 1 ? detail.finest_others * 2 : coarser_others}) {
    if (detail.finest >= coarsest) return runs_section(archive, arrays, detail);
    if (least_share * static_cast<double>(most_signal_bytes(archive, detail)) > static_cast<double>(bytes)) continue;
    PageArrays with_runs = arrays;
    std::optional<json> section = runs_within(archive, with_runs, detail, arrays.bytes() + bytes);
    if (!section) continue;
    arrays = std::move(with_runs);
    return *std::move(section);
  }
}

}  // namespace modebank::app::report
