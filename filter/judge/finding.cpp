#include "filter/judge/finding.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "filter/judge/statistics.hpp"
#include "filter/step/combined_filter.hpp"
#include "filter/step/motions.hpp"
#include "ident/base/clustered_error.hpp"
#include "ident/base/distributions.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Differences at the samples that both filters have scored, run by run. Runs without such samples are skipped.
SeriesByRun differences(const std::vector<Eigen::VectorXd>& better, const std::vector<Eigen::VectorXd>& other) {
  SeriesByRun result;
  for (std::size_t r = 0; r < better.size(); ++r) {
    std::vector<double> run;
    for (const double d : better[r] - other.at(r))
      if (!std::isnan(d)) run.push_back(d);
    if (!run.empty()) result.push_back(std::move(run));
  }
  return result;
}

double stretch_sum(const std::vector<double>& values, std::size_t first, std::size_t count) {
  return Eigen::Map<const Eigen::VectorXd>(values.data() + first, static_cast<Index>(count)).sum();
}

/// Sums over adjacent stretches of `length` samples, and their lengths; 0 means whole runs.
struct Clusters {
  Eigen::VectorXd sums, samples;

  Clusters(const SeriesByRun& d, std::size_t length) {
    std::vector<double> sum, count;
    for (const std::vector<double>& run : d) {
      const std::size_t of_each = length > 0 ? length : run.size();
      for (std::size_t first = 0; first + of_each <= run.size(); first += of_each) {
        sum.push_back(stretch_sum(run, first, of_each));
        count.push_back(static_cast<double>(of_each));
      }
    }
    sums = Eigen::VectorXd::Map(sum.data(), std::ssize(sum));
    samples = Eigen::VectorXd::Map(count.data(), std::ssize(count));
  }
};

/// Standard error of the mean of d by moving blocks. `side_by_side`: number of blocks that fit without overlap.
double error_by_blocks(const SeriesByRun& d, double mean, std::size_t length, double side_by_side) {
  const auto b = static_cast<double>(length);
  double squares = 0.0, count = 0.0;
  for (const auto& run : d)
    for (std::size_t first = 0; first + length <= run.size(); ++first) {
      const double excess = stretch_sum(run, first, length) - mean * b;
      squares += excess * excess;
      ++count;
    }
  return std::sqrt(side_by_side / (side_by_side - 1.0) * squares / count / (b * sample_count(d)));
}

/// One-sided p value of Wilcoxon's signed-rank test (1945, Biometrics Bulletin 1(6)): exact up to 50 differences, with
/// shared ranks for equal sizes, then the normal approximation. Zeros are ignored; 1 if all are.
double signed_rank_p(const Eigen::VectorXd& differences) {
  constexpr std::size_t most_exact = 50;
  std::vector<double> sorted;
  std::copy_if(differences.begin(), differences.end(), std::back_inserter(sorted), [](double d) { return d != 0.0; });
  if (sorted.empty()) return 1.0;
  std::sort(sorted.begin(), sorted.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  // Ranks are doubled: so they are whole numbers even if equal sizes share ranks.
  std::vector<Index> ranks;
  Index sum = 0;
  for (std::size_t first = 0, next = 0; first < sorted.size(); first = next) {
    while (next < sorted.size() && std::abs(sorted[next]) == std::abs(sorted[first])) ++next;
    ranks.resize(next, static_cast<Index>(first + 1 + next));
    for (std::size_t i = first; i < next; ++i) sum += sorted[i] > 0.0 ? ranks[i] : 0;
  }
  const auto all = Eigen::Map<const Eigen::ArrayX<Index>>(ranks.data(), std::ssize(ranks));
  if (sorted.size() > most_exact) {
    const double deviation = std::sqrt(0.5 * all.cast<double>().square().sum());
    return 0.5 * std::erfc((static_cast<double>(sum) - 0.5 * static_cast<double>(all.sum())) / deviation);
  }
  Eigen::VectorXd ways = Eigen::VectorXd::Unit(all.sum() + 1, 0);  // share of the choices of ranks with each sum
  for (const Index rank : ranks)
    for (Index s = ways.size(); s-- > 0;) ways(s) = 0.5 * (ways(s) + (s >= rank ? ways(s - rank) : 0.0));
  return ways.tail(ways.size() - sum).sum();
}

constexpr Index free_run_horizon = 0;
constexpr double noticeable_rmse = 1e-3;  // smallest relative difference of two RMSE that counts
constexpr double rounding_rmse = 1e-8;    // limit of an RMSE of rounding, as a share of a state's standard deviation

// samples; 60 systems with modes had stays of at least 8.4 samples, systems without modes 1.6 samples
constexpr double fewest_stay = 5.0;

/// The first of `all` that has this name; null if there is none.
template <class Named>
const Named* named(const std::vector<Named>& all, std::string Named::*name, const std::string& wanted) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.*name == wanted; });
  return found == all.end() ? nullptr : &*found;
}

/// The competitor with the highest score is that over which the bank gains least.
void set_best_competitor(Finding& finding) {
  finding.gain = finding.standard_error = not_a_number;
  for (const PairedGain& gain : finding.gains) {
    if (std::isnan(gain.gain) || finding.gain <= gain.gain) continue;
    finding.best_competitor = gain.competitor;
    finding.gain = gain.gain;
    finding.standard_error = gain.standard_error;
  }
}

/// Whether the gain of `better` over another description is negligible or insignificant.
bool is_as_good(const PairedGain& of_better) {
  if (of_better.is_negligible()) return true;
  return std::isfinite(of_better.margin) && !of_better.exceeds() && !of_better.ranks_tell();
}

/// Finds the simplest competitor that is as good as the best competitor and as the bank.
void set_better_description(const FindingInputs& in, Finding& finding) {
  const Densities* leader = named(in.competitors, &Densities::filter, finding.best_competitor);
  for (const char* name : competitor_names) {
    const Densities* candidate = named(in.competitors, &Densities::filter, name);
    if (leader && candidate && is_as_good(*gain_over(finding, name)) &&
        is_as_good(paired_gain(name, leader->of_runs, candidate->of_runs, in.response_samples)))
      finding.better_description = name;
    // the remaining competitors are less simple
    if (!finding.better_description.empty() || finding.best_competitor == name) return;
  }
}

Answer answer_of(const Finding& finding) {
  const bool short_stays = finding.stay < finding.stay_asked;
  if (finding.step_scatter > most_step_scatter) return Answer::not_yet;
  if (finding.without_noise || (finding.motions < 2 && !short_stays)) return Answer::one_mode;
  if (!finding.repeating.empty()) return Answer::not_comparable;
  if (!finding.held_out()) return Answer::cannot_tell;
  if (finding.pattern.told()) return Answer::not_yet;  // while lags are missing, gains do not prove modes
  if (finding.gains.empty()) return Answer::cannot_tell;
  for (const PairedGain& gain : finding.gains)
    if (gain.gain + gain.margin < gain.least_gain) return Answer::no_evidence;
  const PairedGain* least = least_beaten(finding);
  return least && least->counts() && !short_stays ? Answer::evidence : Answer::cannot_tell;
}

/// Mean stay of the bank in a motion: 1 / (rate of leaving it); from the most probable sequence of modes if that rate
/// depends on the state and no modes share a motion.
double stay_of(const FindingInputs& in) {
  const bool by_sequence = !in.bank.transition_logit.empty() && motion_count(in.bank) == in.bank.mode_count();
  double used = 0.0, left = 0.0;
  for (const DiagnosticsRow& row : in.diagnostics) {
    if (row.filter != "bank" || row.role != in.role || row.mode < 0) continue;
    const double stay = by_sequence ? row.dwell : stay_in_motion(in.bank, in.bank.motion_of(row.mode));
    used += row.usage;
    left += stay > 0.0 ? row.usage / stay : 0.0;
  }
  return left > 0.0 ? used / left : not_a_number;
}

Description description_of(const Finding& finding) {
  const std::string& simpler = finding.better_description;
  if (finding.answer == Answer::not_yet || finding.answer == Answer::not_comparable) return Description::none;
  if (finding.answer == Answer::evidence) return Description::several_modes;
  if (simpler.empty() && finding.answer != Answer::one_mode) return Description::none;
  if (simpler == "nonlinear") return Description::one_nonlinear_motion;
  return simpler == "drifting" ? Description::one_drifting_motion : Description::one_linear_motion;
}

/// Whether the errors of one linear model are only the rounding of the data.
bool leaves_rounding(const FindingInputs& in) {
  const SummaryRow* row = pooled_row(in.summary, "baseline", in.role);
  return row && row->rmse.size() > 0 &&
         std::equal(row->rmse.begin(), row->rmse.end(), in.states.begin(), in.states.end(),
                    [](double rmse, const Resolution& state) { return rmse < rounding_rmse * state.sd; });
}

/// The competitor with the smallest RMSE at each horizon and state, if it is below that of the bank. Free runs last.
std::vector<BetterMean> better_means(const FindingInputs& in) {
  struct Errors {
    std::string filter;
    Index horizon;
    Eigen::VectorXd rmse;
  };
  std::vector<Errors> all;
  const auto add = [&](const auto& row, Index horizon) {
    if (row.run == "*" && row.role == in.role && row.filter != combined_name)
      all.push_back({row.filter, horizon, row.rmse});
  };
  for (const SummaryRow& row : in.summary) add(row, 1);
  for (const HorizonRow& row : in.horizons)
    if (row.horizon > 1) add(row, row.horizon);
  for (const FreeRunRow& row : in.free_runs) add(row, free_run_horizon);
  std::vector<BetterMean> result;
  for (const Errors& bank : all)
    for (Index i = 0; i < bank.rmse.size() && bank.filter == "bank"; ++i) {
      BetterMean least{"", bank.horizon, "", bank.rmse(i), (1.0 - noticeable_rmse) * bank.rmse(i)};
      for (const Errors& other : all) {
        if (other.filter == "bank" || other.horizon != bank.horizon || !(other.rmse(i) < least.rmse)) continue;
        least.competitor = other.filter;
        least.rmse = other.rmse(i);
      }
      if (in.states.size() > 1) least.state = in.states[i].state;
      if (!least.competitor.empty()) result.push_back(least);
    }
  return result;
}

}  // namespace

PairedGain paired_gain(const std::string& competitor, const std::vector<Eigen::VectorXd>& better,
                       const std::vector<Eigen::VectorXd>& other, double response_samples) {
  constexpr std::size_t fewest_runs = 5;
  constexpr double fewest_blocks = 8.0, times_per_block = 2.0, upper_probability = 0.975;
  const SeriesByRun d = differences(better, other);
  PairedGain result{competitor, static_cast<Index>(sample_count(d)), mean_of(d)};
  result.by_blocks = d.size() < fewest_runs;
  result.standard_error = result.margin = not_a_number;
  if (!std::isfinite(result.gain)) return result;
  result.least_gain = least_nats(sample_count(d), response_samples) / sample_count(d);
  const double block = times_per_block * cautious_time(autocorrelation_time(d), sample_count(d));
  const std::size_t length = result.by_blocks ? static_cast<std::size_t>(std::ceil(block)) : 0;
  const Clusters clusters(d, length);
  const auto count = static_cast<double>(clusters.sums.size());
  result.rank_p = signed_rank_p(clusters.sums.cwiseQuotient(clusters.samples));
  if (result.by_blocks && count < fewest_blocks) return result;
  result.standard_error = result.by_blocks ? error_by_blocks(d, result.gain, length, count)
                                           : clustered_error(clusters.sums, clusters.samples);
  result.degrees_of_freedom = count - 1.0;
  result.margin = student_quantile(upper_probability, result.degrees_of_freedom) * result.standard_error;
  return result;
}

const char* description_of(const std::string& competitor) {
  if (competitor == "baseline") return "one linear model with constant noise";
  if (competitor == "noise_only" || competitor == "one_motion") return "one linear model with changing noise";
  if (competitor == "drifting") return "one linear model whose parameters wander";
  if (competitor == "nonlinear") return "one nonlinear model";
  return "";
}

const PairedGain* gain_over(const Finding& finding, const std::string& competitor) {
  return named(finding.gains, &PairedGain::competitor, competitor);
}

Doubt doubt_of(const Finding& finding) {
  if (!finding.held_out()) return Doubt::nothing_held_out;
  if (finding.gains.empty()) return Doubt::no_competitor;
  if (!least_beaten(finding)) return Doubt::few_samples;
  const PairedGain& least = *least_beaten(finding);
  if (!least.told()) return Doubt::within_chance;
  return least.is_negligible() ? Doubt::small_gain : Doubt::short_stays;
}

const PairedGain* least_beaten(const Finding& finding) {
  const auto comes_before = [](const PairedGain& a, const PairedGain& b) {
    if (a.told() != b.told()) return b.told();
    return a.is_negligible() != b.is_negligible() ? a.is_negligible() : a.gain * b.margin < b.gain * a.margin;
  };
  const PairedGain* least = nullptr;
  for (const PairedGain& gain : finding.gains) {
    if (!std::isfinite(gain.margin)) return nullptr;
    if (!least || comes_before(gain, *least)) least = &gain;
  }
  return least;
}

Finding judge_modes(const FindingInputs& in) {
  Finding finding;
  finding.role = in.role;
  finding.runs = std::count_if(in.bank_densities.of_runs.begin(), in.bank_densities.of_runs.end(),
                               [](const Eigen::VectorXd& run) { return (!run.array().isNaN()).any(); });
  finding.modes = in.bank.mode_count();
  finding.motions = counted_motions(in.bank);
  finding.step_scatter = in.step_scatter;
  finding.pattern = in.pattern;
  finding.stay = stay_of(in);
  finding.stay_asked = std::max(fewest_stay, static_cast<double>(in.bank.structure.first_transition() + 1));
  finding.without_noise = leaves_rounding(in);
  std::copy_if(in.states.begin(), in.states.end(), std::back_inserter(finding.repeating),
               [](const Resolution& state) { return state.repeated > repeated_share; });
  for (const Densities& competitor : in.competitors)
    finding.gains.push_back(
        paired_gain(competitor.filter, in.bank_densities.of_runs, competitor.of_runs, in.response_samples));
  set_best_competitor(finding);
  finding.answer = answer_of(finding);
  const bool densities_tell =
      finding.answer != Answer::not_comparable && finding.answer != Answer::not_yet && !finding.without_noise;
  const PairedGain* over_best = gain_over(finding, finding.best_competitor);
  if (densities_tell && !(over_best && over_best->counts())) set_better_description(in, finding);
  finding.description = description_of(finding);
  if (finding.modes > 1 && !finding.without_noise) finding.better_means = better_means(in);
  return finding;
}

}  // namespace modebank
