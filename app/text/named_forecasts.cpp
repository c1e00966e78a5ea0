#include "app/text/named_forecasts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "app/text/judged_runs.hpp"
#include "app/text/number_text.hpp"
#include "filter/judge/decide/finding.hpp"
#include "ident/base/clustered_error.hpp"

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

/// Mean log score and number of samples of each judged run.
struct OfRuns {
  std::vector<double> score, samples;
};

template <class Row>
void add_runs(const std::vector<Row>& rows, const std::string& filter, Role role, Index steps, OfRuns& runs) {
  for (const Row& row : rows) {
    if (row.filter != filter || row.role != role || row.run == "*" || horizon_of(row) != steps || row.samples == 0)
      continue;
    runs.score.push_back(row.log_score);
    runs.samples.push_back(static_cast<double>(row.samples));
  }
}

OfRuns runs_of(const Archive& archive, const std::string& filter, Index steps) {
  OfRuns runs;
  if (steps == 1) add_runs(archive.summary, filter, judged_role(archive), steps, runs);
  if (runs.score.empty()) add_runs(archive.horizons, filter, judged_role(archive), steps, runs);
  return runs;
}

struct Gain {
  double mean = not_a_number, error = not_a_number;
};

/// Gain of log score on the judged runs, over another filter.
Gain gain_over(const Archive& archive, const std::string& better, const std::string& other, Index steps) {
  const OfRuns a = runs_of(archive, better, steps), b = runs_of(archive, other, steps);
  if (a.score.empty() || a.samples != b.samples) return {};
  Eigen::VectorXd sums(std::ssize(a.score)), samples(sums.size());
  for (Index i = 0; i < sums.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    samples(i) = a.samples[at];
    sums(i) = samples(i) * (a.score[at] - b.score[at]);
  }
  return {sums.sum() / samples.sum(), sums.size() > 1 ? clustered_error(sums, samples) : not_a_number};
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
         gain_over(archive, good->filter, simpler, steps).mean < negligible_gain))
      return &one;
  return good;
}

/// Whether the C code of `export --to c` supports the filter.
bool runs_in_c(const Archive& archive, const std::string& filter) {
  if (filter == combined_name) return false;
  const std::optional<Bank> bank = archive.bank_of(filter);
  return bank && bank->terms.empty() && bank->noise_factor.empty() && !bank->is_quantised();
}

NamedForecast named(const Archive& archive, const std::vector<Reached>& all, const Reached& chosen, Index steps) {
  NamedForecast forecast;
  forecast.steps = steps;
  forecast.filter = chosen.filter;
  if (chosen.filter != "bank")
    forecast.other = "bank";
  else if (const Reached* next = simplest_good(all, [](const std::string& name) { return name != "bank"; }))
    forecast.other = next->filter;
  const Gain gain = gain_over(archive, forecast.filter, forecast.other, steps);
  forecast.gain = gain.mean;
  forecast.error = gain.error;
  const Reached* in_c = simplest_good(all, [&](const std::string& name) { return runs_in_c(archive, name); });
  if (!in_c || in_c->filter == chosen.filter) return forecast;
  forecast.c_filter = in_c->filter;
  forecast.c_loss = gain_over(archive, forecast.filter, in_c->filter, steps).mean;
  return forecast;
}

std::string understanding(const Archive& archive) {
  const Finding& finding = *archive.finding;
  if (finding.answer == Answer::evidence) return fmt::format("the {} modes", archive.bank->mode_count());
  if (!finding.better_description.empty()) return fmt::format("`{}`", finding.better_description);
  return archive.bank->mode_count() == 1 ? "the one mode" : "the modes, with care";
}

/// The filter to compare with: the finding's best competitor. If that competitor is itself the named forecast, the
/// bank.
std::string reference_of(const NamedForecast& forecast, const Finding& finding) {
  const std::string& competitor = finding.best_competitor;
  return competitor.empty() || competitor == forecast.filter ? "bank" : competitor;
}

/// Text such as " (+0.041 +- 0.012 nats over `drifting`; in C `bank`, -0.041)".
std::string worth(const Archive& archive, const NamedForecast& forecast) {
  std::vector<std::string> parts;
  const std::string other = reference_of(forecast, *archive.finding);
  const Gain gain = other == forecast.filter ? Gain{} : gain_over(archive, forecast.filter, other, forecast.steps);
  if (!std::isnan(gain.mean)) {
    const std::string error = std::isnan(gain.error) ? "" : fmt::format(" +- {:.3f}", gain.error);
    const bool chance = std::abs(gain.mean) <= gain.error;
    parts.push_back(
        fmt::format("{:+.3f}{} nats over `{}`{}", gain.mean, error, other, chance ? ", within its error" : ""));
  }
  if (!forecast.c_filter.empty())
    parts.push_back("in C `" + forecast.c_filter + "`" +
                    (std::isnan(forecast.c_loss) ? "" : fmt::format(", {:+.3f}", -forecast.c_loss)));
  return parts.empty() ? "" : fmt::format(" ({})", fmt::join(parts, "; "));
}

std::string steps_words(Index steps) { return fmt::format("{} step{} ahead", steps, steps == 1 ? "" : "s"); }

}  // namespace

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

std::string use_words(const Archive& archive) {
  if (!archive.finding || !archive.bank) return "";
  const std::vector<NamedForecast> forecasts = named_forecasts(archive);
  std::string text = "to understand the motion: " + understanding(archive);
  for (const NamedForecast& forecast : forecasts) {
    text += fmt::format("; {}{}: `--track.filter {}`{}", &forecast == &forecasts.front() ? "to predict " : "",
                        steps_words(forecast.steps), forecast.filter, worth(archive, forecast));
  }
  return text;
}

}  // namespace modebank::app
