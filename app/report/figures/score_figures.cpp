#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/chain/judged_runs.hpp"
#include "app/report/figures/palette.hpp"
#include "app/report/figures/run_figures.hpp"
#include "app/report/page/assets.hpp"
#include "app/report/page/pit_histogram.hpp"
#include "filter/judge/decide/finding.hpp"

namespace modebank::app::report {
namespace {

constexpr Index bins_of_figure = 20;

/// The competitors, and over them the bank.
std::vector<std::string> drawn_filters() {
  std::vector<std::string> filters(competitor_names.begin(), competitor_names.end());
  filters.emplace_back("bank");
  return filters;
}

std::string colour_of(const std::string& filter) { return palette().filters.at(filter); }

std::string title_of(const Archive& archive, std::string filter) {
  if (filter == "bank") return bank_title(archive);
  std::replace(filter.begin(), filter.end(), '_', ' ');
  return filter;
}

PitHistogram judged_histogram(const Archive& archive, const FilterEvaluation& evaluation) {
  return pit_histogram(evaluation, positions_of(*archive.recording, judged_role(archive)), bins_of_figure);
}

Figure pit(const Archive& archive) {
  Figure figure("pit", assets::figure_pit());
  std::vector<std::string> titles, colours;
  for (const std::string& filter : drawn_filters()) {
    const FilterEvaluation* evaluation = evaluation_of(archive, filter);
    if (!evaluation) continue;
    const PitHistogram histogram = judged_histogram(archive, *evaluation);
    Eigen::MatrixXd rows(bins_of_figure, 2);
    for (Index i = 0; i < bins_of_figure; ++i)
      rows.row(i) << (static_cast<double>(i) + 0.5) / static_cast<double>(bins_of_figure),
          histogram.counts(i) / histogram.expected;
    figure.add_block(title_of(archive, filter), {"PIT", "density"}, rows);
    titles.push_back(title_of(archive, filter));
    colours.push_back(colour_of(filter));
    if (titles.size() > 1) continue;
    figure.set("uniform_low", histogram.band.lower / histogram.expected);
    figure.set("uniform_high", histogram.band.upper / histogram.expected);
  }
  figure.set("filters", static_cast<Index>(titles.size()));
  figure.set("filter_title", titles);
  figure.set("filter_colour", colours);
  figure.set_caption(
      fmt::format("Histogram of the probability integral transform (PIT) of the one-step predictions on the "
                  "{} runs: flat for a true filter; grey: where 95 % of its bars lie.",
                  words_for(judged_role(archive))));
  return figure;
}

Figure coverage(const Archive& archive) {
  Figure figure("coverage", assets::figure_coverage());
  std::vector<std::string> titles;
  Eigen::MatrixXd rows(0, 5);
  for (const std::string& filter : drawn_filters()) {
    const SummaryRow* train = pooled_row(archive, filter, Role::train);
    const SummaryRow* test = pooled_row(archive, filter, Role::test);
    if (!train && !test) continue;
    titles.push_back(title_of(archive, filter));
    rows.conservativeResize(rows.rows() + 1, 5);
    const auto percent = [](const SummaryRow* row, double SummaryRow::*member) {
      return row ? 100 * row->*member : std::numeric_limits<double>::quiet_NaN();
    };
    rows.bottomRows(1) << static_cast<double>(titles.size()), percent(train, &SummaryRow::nis_above),
        percent(train, &SummaryRow::nis_below), percent(test, &SummaryRow::nis_above),
        percent(test, &SummaryRow::nis_below);
  }
  figure.set("filters", static_cast<Index>(titles.size()));
  figure.set("filter_title", titles);
  figure.add_block("NIS outside its 95 % interval [%]",
                   {"position", "train above", "train below", "test above", "test below"}, rows);
  figure.set_caption(
      "Share of samples whose normalised innovation squared (NIS) lies above (upwards) or below (downwards) "
      "its 95 % interval; 2.5 % on either side is true.");
  return figure;
}

}  // namespace

void add_score_figures(const Archive& archive, FigureSet& set) {
  if (archive.summary.empty() || !archive.recording) {
    set.left_out.emplace_back("pit and coverage: the archive holds no scores");
    return;
  }
  set.figures.push_back(pit(archive));
  set.figures.push_back(coverage(archive));
}

std::string bank_title(const Archive& archive) {
  return fmt::format("bank, {} mode{}", archive.bank->mode_count(), archive.bank->mode_count() == 1 ? "" : "s");
}

const FilterEvaluation* evaluation_of(const Archive& archive, const std::string& filter) {
  for (const FilterEvaluation& evaluation : archive.evaluations)
    if (evaluation.filter == filter) return &evaluation;
  return nullptr;
}

FigureSet run_figures(const Archive& archive, const std::string& run) {
  FigureSet set;
  add_window_figures(archive, set);
  add_time_figures(archive, run, set);
  add_score_figures(archive, set);
  add_transition_figure(archive, set);
  return set;
}

}  // namespace modebank::app::report
