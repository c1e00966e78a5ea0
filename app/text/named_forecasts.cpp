#include "app/text/named_forecasts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "app/text/judged_runs.hpp"
#include "app/text/motions.hpp"
#include "filter/judge/finding.hpp"

namespace modebank::app {
namespace {

/// Score of one filter at one horizon.
struct Reached {
  std::string filter;
  double log_score = 0.0;
};

template <class Row>
Index horizon_of(const Row& row) {
  if constexpr (requires { row.horizon; }) return row.horizon;
  return 1;
}

template <class Row>
void add(const std::vector<Row>& rows, Role role, Index steps, std::vector<Reached>& reached) {
  for (const Row& row : rows) {
    if (horizon_of(row) != steps || row.samples == 0) continue;
    if constexpr (requires { row.role; })
      if (row.role != role || row.run != "*") continue;
    if (std::none_of(reached.begin(), reached.end(), [&](const Reached& r) { return r.filter == row.filter; }))
      reached.push_back({row.filter, row.log_score});
  }
}

/// Scores of all filters on the training runs, the simplest filter first: the competitors, the bank, the combination.
std::vector<Reached> reached_in_training(const Archive& archive, Index steps) {
  std::vector<Reached> reached;
  add(archive.left_out, Role::train, steps, reached);
  const bool learned = reached.empty();
  if (learned && steps == 1) add(archive.summary, Role::train, steps, reached);
  if (learned) add(archive.horizons, Role::train, steps, reached);
  const auto place = [](const Reached& one) {
    return std::find(competitor_names.begin(), competitor_names.end(), one.filter) - competitor_names.begin() +
           (one.filter == combined_name);
  };
  std::sort(reached.begin(), reached.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return reached;
}

/// The simplest filter that loses less than 0.02 nats against the best, as in the finding. Null if there are none. Only
/// filters for which `may` returns true are compared.
template <class May>
const Reached* simplest_good(const std::vector<Reached>& all, May may) {
  double best = -std::numeric_limits<double>::infinity();
  for (const Reached& one : all)
    if (may(one.filter)) best = std::fmax(best, one.log_score);
  for (const Reached& one : all)
    if (may(one.filter) && one.log_score > best - negligible_gain) return &one;
  return nullptr;
}

/// Gain of a filter over another on the judged runs; NaN if unknown.
double judged_gain(const Archive& archive, const std::string& filter, const std::string& other, Index steps) {
  const Role role = judged_role(archive);
  const auto a = scores_ahead(archive, filter, role, steps), b = scores_ahead(archive, other, role, steps);
  return a && b ? a->log_score - b->log_score : not_a_number;
}

/// The filter to name at a horizon; null without filters. Nothing is named against the simpler model of the finding, or
/// against its best competitor, if the judged runs show no gain that counts. One step ahead the finding itself decides
/// between bank and model.
const Reached* best_of(const Archive& archive, const std::vector<Reached>& all, Index steps) {
  const Reached* good = simplest_good(all, [](const std::string&) { return true; });
  if (!good || !archive.finding) return good;
  const std::string& described = archive.finding->better_description;
  const std::string& simpler = described.empty() ? archive.finding->best_competitor : described;
  for (const Reached& one : all)
    if (&one < good && one.filter == simpler &&
        ((steps == 1 && good->filter == "bank" && simpler == described) ||
         judged_gain(archive, good->filter, simpler, steps) < negligible_gain))
      return &one;
  return good;
}

bool runs_in_c(const Archive& archive, const std::string& filter) {
  if (filter == combined_name) return false;
  const std::optional<Bank> bank = archive.bank_of(filter);
  return bank && c_lacks(*bank).empty();
}

NamedForecast named(const Archive& archive, const std::vector<Reached>& all, const Reached& chosen, Index steps) {
  const Reached* in_c = simplest_good(all, [&](const std::string& name) { return runs_in_c(archive, name); });
  const bool itself = !in_c || runs_in_c(archive, chosen.filter);
  const auto scores = scores_ahead(archive, chosen.filter, judged_role(archive), steps);
  return {steps, chosen.filter, scores ? scores->rmse : Eigen::VectorXd(), itself ? chosen.filter : in_c->filter};
}

std::string understanding(const Archive& archive) {
  const Finding& finding = *archive.finding;
  if (finding.answer == Answer::evidence) return "the " + counted_words(*archive.bank);
  if (!finding.better_description.empty()) return fmt::format("`{}`", finding.better_description);
  return archive.bank->mode_count() == 1 ? "the one mode" : "the modes, with care";
}

std::string steps_words(Index steps) { return fmt::format("{} step{} ahead", steps, steps == 1 ? "" : "s"); }

}  // namespace

std::string c_lacks(const Bank& bank) {
  if (!bank.running_noise.empty()) return "coefficients that learn in every run";
  if (!bank.terms.empty()) return "a motion that bends (window.terms)";
  return bank.is_quantised() ? "measurements in steps (data.quantum)" : "";
}

std::vector<NamedForecast> named_forecasts(const Archive& archive) {
  std::set<Index> horizons{1};
  for (const HorizonRow& row : archive.horizons) horizons.insert(row.horizon);
  std::vector<NamedForecast> forecasts;
  for (const Index steps : horizons) {
    const std::vector<Reached> all = reached_in_training(archive, steps);
    if (const Reached* chosen = best_of(archive, all, steps)) forecasts.push_back(named(archive, all, *chosen, steps));
  }
  return forecasts;
}

std::string use_words(const Archive& archive, const std::vector<NamedForecast>& forecasts) {
  if (!archive.finding || !archive.bank) return "";
  std::string text = "to understand the motion: " + understanding(archive);
  for (const NamedForecast& forecast : forecasts) {
    const std::string rmse =
        forecast.rmse.size() > 0 ? fmt::format(" (RMSE {:.3g})", fmt::join(forecast.rmse, ", ")) : "";
    text += fmt::format("; {}{}: `--track.filter {}`{}", &forecast == &forecasts.front() ? "to predict " : "",
                        steps_words(forecast.steps), forecast.filter, rmse);
  }
  return text;
}

}  // namespace modebank::app
