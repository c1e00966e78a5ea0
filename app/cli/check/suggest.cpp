#include "app/cli/check/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "app/chain/stage_inputs.hpp"
#include "app/cli/check/left_out.hpp"
#include "app/text/next_step.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Every change of a model must gain this much, because a smaller gain would not repeat on other runs.
bool is_taken(const PairedGain& gain) {
  return is_worth_it(PairedLoss{gain.gain, gain.standard_error},
                     Eigen::VectorXd::Constant(1, static_cast<double>(gain.samples)));
}

CheckOptions check_options(const ChainOptions& options) {
  return {options.data, options.window.length, options.window.intercept};
}

/// The sequence of trials. Keeps the predictions of all accepted settings; the first entry belongs to the present
/// settings.
class Search {
 public:
  Search(const ChainOptions& options, const DataCheck& check, const SuggestionScope& scope, const Listener& listener)
      : options_(options), check_(check), scope_(scope), listener_(listener), plan_(plan_left_out(check)) {
    found_.present = found_.suggested = settings_of(options);
    found_.runs = std::ssize(plan_.runs);
    found_.whole_runs = !plan_.parts.empty();
    common_s_ = common_time_s();
  }

  Suggestions run() {
    held_.push_back(predict(found_.present, false));
    if (!held_.front().problem.empty()) {
      found_.unscored = held_.front().problem;
      return found_;
    }
    if (scope_.has(Change::rate)) try_rate();
    if (scope_.has(Change::lag)) try_lag();
    if (scope_.has(Change::length)) try_length();
    if (scope_.has(Change::loss)) try_loss();
    if (scope_.has(Change::noise)) try_noise();
    if (scope_.has(Change::restarts)) try_restarts();
    judge_together();
    return found_;
  }

 private:
  const ChainOptions& options_;
  DataCheck check_;  ///< check of the data with the accepted settings
  const SuggestionScope& scope_;
  const Listener& listener_;
  LeftOutPlan plan_;
  double common_s_ = 0.0;
  std::vector<LeftOut> held_;   ///< predictions without random starts
  std::vector<LeftOut> whole_;  ///< predictions with random starts; the first is computed on demand
  Suggestions found_;

  Settings& held() { return found_.suggested; }

  /// Without a column of times, the configuration states the rate, so the rate cannot be changed.
  bool has_times() const { return !options_.data.time.empty(); }

  double wanted_hz() const { return check_.advice.rate.rate_hz; }
  double present_hz() const {
    return found_.present.rate_hz > 0.0 ? found_.present.rate_hz : check_.advice.rate_facts.inputs_hz;
  }

  /// The longer sample period of the two rates to compare.
  double common_time_s() const {
    return 1.0 / (wanted_hz() > 0.0 ? std::min(wanted_hz(), present_hz()) : present_hz());
  }

  /// Whether refinement has random starts, which need at least half of its time.
  bool has_random_starts() const {
    return !scope_.one_motion && options_.bank.em.restarts > 0 && chain_inputs(options_).bank.bank.refine == Refine::em;
  }

  /// Names of the settings that differ from the present settings, for messages.
  std::string other_words(const Settings& settings) const {
    std::string words;
    if (settings.measurement_variance != found_.present.measurement_variance)
      words += fmt::format(", measurement variance {:.3g}", *settings.measurement_variance);
    if (settings.restarts != found_.present.restarts) words += fmt::format(", {} restarts", settings.restarts);
    return words;
  }

  LeftOut predict(const Settings& settings, bool random_starts) const {
    const Stopwatch watch;
    ChainOptions options = with_settings(options_, settings);
    if (!random_starts) options.bank.em.restarts = 0;
    if (scope_.one_motion) options.mixture.selection.components = {1};
    LeftOut left_out = predict_left_out(options, plan_, common_s_);
    listener_.progress(
        fmt::format("tried: rate {}, lag {}, length {}, loss {}{} scored on {} training runs left out in {:.2f} s",
                    settings.rate_hz > 0.0 ? fmt::format("{:g} Hz", settings.rate_hz) : "as recorded",
                    settings.lag_auto ? "auto" : fmt::format("{:g} s", settings.lag_s), settings.window_length,
                    name_of(settings.loss), other_words(settings), plan_.runs.size(), watch.seconds()));
    return left_out;
  }

  DataCheck checked(const Settings& settings, double lag_s) const {
    ChainOptions options = with_settings(options_, settings);
    options.data.lag_auto = false;
    options.data.lag_s = lag_s;
    return check_data(check_options(options));
  }

  void attempt(Change change, const Settings& to, const Advice& advice) {
    Trial trial{change, held(), to, advice, {}, {}, false, rest_noise(check_)};
    LeftOut said = predict(to, false);
    judge(said, held_.back(), trial);
    if (trial.accepted) confirm(std::move(said), trial);
    found_.trials.push_back(std::move(trial));
  }

  static void judge(const LeftOut& said, const LeftOut& before, Trial& trial) {
    trial.unscored = said.problem.empty() ? before.problem : said.problem;
    trial.gain = trial.unscored.empty() ? compare_left_out(said, before) : PairedGain{};
    trial.accepted = trial.unscored.empty() && is_taken(trial.gain);
    if (trial.unscored.empty() && (!std::isfinite(trial.gain.gain) || std::isnan(trial.gain.standard_error)))
      trial.unscored = "there are too few predictions of the same samples to compare";
  }

  void start_whole() {
    if (whole_.empty()) whole_.push_back(has_random_starts() ? predict(found_.present, true) : held_.front());
  }

  /// A gain without random starts must be confirmed with random starts. Otherwise the gain could come from an optimum
  /// that `run` does not reach.
  void confirm(LeftOut said, Trial& trial) {
    start_whole();
    LeftOut whole = has_random_starts() ? predict(trial.to, true) : said;
    judge(whole, whole_.back(), trial);
    if (!trial.accepted) return;
    held() = trial.to;
    held_.push_back(std::move(said));
    whole_.push_back(std::move(whole));
  }

  void try_rate() {
    if (wanted_hz() == held().rate_hz || wanted_hz() > highest_rate_hz || !has_times()) return;
    Settings to = held();
    to.rate_hz = wanted_hz();
    DataCheck then;
    try {
      then = checked(to, to.lag_s);
    } catch (const std::runtime_error& error) {  // at that rate the blocks are too short for windows
      return found_.trials.push_back({Change::rate, held(), to, check_.advice, {}, error.what(), false});
    }
    if (then.advice.length.length > 0) to.window_length = then.advice.length.length;
    to.window_step = std::max<Index>(1, std::lround(static_cast<double>(to.window_step) * wanted_hz() / present_hz()));
    Advice advice = then.advice;
    advice.rate_facts = check_.advice.rate_facts;
    advice.rate = check_.advice.rate;
    attempt(Change::rate, to, advice);
    if (found_.trials.back().accepted) check_ = std::move(then);
  }

  void try_lag() {
    if (!check_.has_lag || check_.lag.correction == LagCorrection::none || held().lag_auto || held().lag_s != 0.0)
      return;
    Settings to = held();
    to.lag_auto = true;
    Trial unscored{Change::lag, held(), to, check_.advice, {}, "there are fewer than three training runs", false};
    if (plan_.parts.empty())
      return found_.trials.push_back(unscored);  // without parts, a run's lag would be estimated from the run itself
    attempt(Change::lag, to, check_.advice);
    if (found_.trials.back().accepted) check_ = checked(to, check_.lag.lag.mean);
  }

  void try_length() {
    const bool with_rate =
        held().rate_hz != found_.present.rate_hz;  // the rate and the length of windows change together
    Settings to = held();
    to.window_length = check_.advice.length.length;
    if (to.window_length == 0 || to.window_length == held().window_length || with_rate) return;
    attempt(Change::length, to, check_.advice);
  }

  void try_loss() {
    Settings to = held();
    to.loss = check_.advice.loss.loss;
    if (check_.advice.loss.tails.transitions > 0 && to.loss != held().loss) attempt(Change::loss, to, check_.advice);
  }

  /// Tries the state's variance at rest as R. Not used with drift, because drift needs exactly measured states.
  void try_noise() {
    const RestNoise rest = rest_noise(check_);
    if (held().measurement_variance || !(rest.variance > 0.0) || options_.bank.em.drift != Drift::none) return;
    Settings to = held();
    to.measurement_variance = std::stod(fmt::format("{:.2e}", rest.variance));
    attempt(Change::noise, to, check_.advice);
  }

  /// The trial changes the random starts, so it is judged with random starts at once.
  void try_restarts() {
    using app::many_restarts;
    if (held().restarts >= many_restarts || !has_random_starts()) return;
    Trial trial{Change::restarts, held(), held(), check_.advice, {}, {}, false};
    trial.to.restarts = many_restarts;
    start_whole();
    LeftOut whole = predict(trial.to, true);
    judge(whole, whole_.back(), trial);
    if (trial.accepted) {
      held() = trial.to;
      whole_.push_back(std::move(whole));
    }
    found_.trials.push_back(std::move(trial));
  }

  void judge_together() {
    for (auto last = found_.trials.rbegin(); last != found_.trials.rend(); ++last) {
      if (!last->accepted) continue;
      found_.together = compare_left_out(whole_.back(), whole_.front());
      if (is_taken(found_.together)) return;
      last->accepted = false;
      held() = last->from;
      whole_.pop_back();
    }
  }
};

}  // namespace

Suggestions suggest(const ChainOptions& options, const DataCheck& check, const SuggestionScope& scope,
                    const Listener& listener) {
  return Search(options, check, scope, listener).run();
}

}  // namespace modebank
