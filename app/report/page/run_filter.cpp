#include <fmt/format.h>

#include <set>

#include "app/report/page/numbers.hpp"
#include "app/report/page/pit_histogram.hpp"
#include "app/report/page/residual_pool.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/unit_text.hpp"
#include "app/text/judged_runs.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

constexpr Index pit_bins = 20;

json score_row(const SummaryRow& row) {
  return {{"filter", row.filter},
          {"role", name_of(row.role)},
          {"run", row.run},
          {"samples", count(row.samples)},
          {"log_score", number(row.log_score, fmt::format("{:.4f}", row.log_score))},
          {"rmse", number_list(row.rmse)},
          {"nis_mean", number(row.nis_mean, fmt::format("{:.3f}", row.nis_mean))},
          {"nis_above", percent(row.nis_above)},
          {"nis_below", percent(row.nis_below)},
          {"coverage_50", percent(row.coverage_50)},
          {"coverage_90", percent(row.coverage_90)},
          {"coverage_95", percent(row.coverage_95)},
          {"coverage_99", percent(row.coverage_99)},
          {"too_far", percent(row.too_far)},
          {"too_close", percent(row.too_close)},
          {"pit_distance", number(row.pit_distance)},
          {"whiteness_p", number(row.whiteness_p)}};
}

json histogram_of(const Archive& archive, const FilterEvaluation& evaluation, Role role) {
  const PitHistogram histogram = pit_histogram(evaluation, positions_of(*archive.recording, role), pit_bins);
  return {{"filter", evaluation.filter},
          {"role", name_of(role)},
          {"counts", std::vector<int>(histogram.counts.begin(), histogram.counts.end())},
          {"samples", histogram.samples},
          {"expected", histogram.expected},
          {"band", {histogram.band.lower, histogram.band.upper}}};
}

json autocorrelation_of(const Archive& archive, const ResidualTestSet& set, Role role) {
  std::vector<ResidualTests> runs;
  for (std::size_t i = 0; i < set.runs.size(); ++i)
    if (archive.recording->runs[i].role == role) runs.push_back(set.runs[i]);
  const ResidualTests pooled = pool_autocorrelations(runs);
  json states = json::array();
  for (Index i = 0; i < pooled.states(); ++i)
    states.push_back(std::vector<double>(pooled.autocorrelation.row(i).begin(), pooled.autocorrelation.row(i).end()));
  return {{"model", set.model},
          {"role", name_of(role)},
          {"samples", pooled.samples},
          {"level", pooled.level},
          {"band", pooled.autocorrelation_band},
          {"states", states}};
}

json horizon_row(const HorizonRow& row) {
  return {{"filter", row.filter},
          {"role", name_of(row.role)},
          {"horizon", count(row.horizon)},
          {"samples", count(row.samples)},
          {"log_score", number(row.log_score, fmt::format("{:.4f}", row.log_score))},
          {"rmse", number_list(row.rmse)}};
}

/// Percentages of all states in one cell.
json percent_list(const Eigen::VectorXd& shares) {
  json cell = number_list(shares);
  std::string text;
  for (const double share : shares) text += (text.empty() ? "" : ", ") + percent_text(share);
  cell["t"] = text;
  return cell;
}

json free_run_row(const FreeRunRow& row) {
  return {{"filter", row.filter},
          {"role", name_of(row.role)},
          {"run", row.run},
          {"start", count(row.start)},
          {"samples", count(row.samples)},
          {"log_score", number(row.log_score, fmt::format("{:.4f}", row.log_score))},
          {"rmse", number_list(row.rmse)},
          {"nrmse", number_list(row.nrmse)},
          {"fit", number_list(row.fit)},
          {"coverage_50", percent_list(row.coverage_50)},
          {"coverage_95", percent_list(row.coverage_95)}};
}

json verdict_row(const DiagnosticsRow& row) {
  const auto with_interval = [](double share, double lower, double upper) {
    return number(share, fmt::format("{} [{:.2f}, {:.2f}]", percent_text(share), 100 * lower, 100 * upper));
  };
  return {{"filter", row.filter},
          {"role", name_of(row.role)},
          {"verdict", name_of(row.verdict)},
          {"coverage_50", with_interval(row.coverage_50, row.coverage_50_lower, row.coverage_50_upper)},
          {"coverage_90", with_interval(row.coverage_90, row.coverage_90_lower, row.coverage_90_upper)},
          {"coverage_95", with_interval(row.coverage_95, row.coverage_95_lower, row.coverage_95_upper)},
          {"coverage_99", with_interval(row.coverage_99, row.coverage_99_lower, row.coverage_99_upper)},
          {"too_far", with_interval(row.too_far, row.too_far_lower, row.too_far_upper)},
          {"too_close", with_interval(row.too_close, row.too_close_lower, row.too_close_upper)},
          {"nis_mean", number(row.nis_mean, fmt::format("{:.3f}", row.nis_mean))},
          {"flags", row.flags}};
}

}  // namespace

nlohmann::json filter_section(const Archive& archive) {
  if (!archive.recording || archive.evaluations.empty()) return nullptr;
  json section = {
      {"scores", json::array()},           {"histograms", json::array()},
      {"autocorrelations", json::array()}, {"horizons", json::array()},
      {"free_runs", json::array()},        {"verdicts", json::array()},
      {"tail", 0.5 * (1.0 - drawn_level)}, {"rmse_name", with_unit("RMSE", common_unit(archive.recording->states))}};
  std::set<std::string> listed{"*"};
  for (const std::size_t i : drawn_runs(*archive.recording)) listed.insert(archive.recording->runs[i].run);
  for (const SummaryRow& row : archive.summary)
    if (listed.contains(row.run)) section["scores"].push_back(score_row(row));
  for (const Role role : {Role::test, Role::train}) {
    for (const FilterEvaluation& evaluation : archive.evaluations) {
      json histogram = histogram_of(archive, evaluation, role);
      if (histogram["samples"] > 0) section["histograms"].push_back(histogram);
    }
    for (const ResidualTestSet& set : archive.residual_tests) {
      json autocorrelation = autocorrelation_of(archive, set, role);
      if (autocorrelation["samples"] > 0) section["autocorrelations"].push_back(autocorrelation);
    }
  }
  for (const HorizonRow& row : archive.horizons)
    if (row.run == "*") section["horizons"].push_back(horizon_row(row));
  for (const FreeRunRow& row : archive.free_runs)
    if (row.run == "*") section["free_runs"].push_back(free_run_row(row));
  for (const DiagnosticsRow& row : archive.diagnostics)
    if (row.mode < 0) section["verdicts"].push_back(verdict_row(row));
  return section;
}

}  // namespace modebank::app::report
