#include "app/cli/check/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/chain/stage_inputs.hpp"
#include "app/cli/check/left_out.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// By the rule of whatever a model may add: less would not survive on other runs.
bool is_taken(const PairedGain& gain) {
  return is_worth_it(PairedLoss{gain.gain, gain.standard_error},
                     Eigen::VectorXd::Constant(1, static_cast<double>(gain.samples)));
}

CheckOptions check_options(const ChainOptions& options) {
  return {options.data, options.window.length, options.window.intercept};
}

/// The way through the trials. Predictions of all that was accepted are kept, those of the present settings first.
class Search {
 public:
  Search(const ChainOptions& options, const DataCheck& check, const Listener& listener)
      : options_(options), check_(check), listener_(listener), plan_(plan_left_out(check)) {
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
    try_rate();
    try_lag();
    try_length();
    try_loss();
    judge_together();
    return found_;
  }

 private:
  const ChainOptions& options_;
  DataCheck check_;  ///< of the data as accepted so far
  const Listener& listener_;
  LeftOutPlan plan_;
  double common_s_ = 0.0;
  std::vector<LeftOut> held_;   ///< without random starts
  std::vector<LeftOut> whole_;  ///< with them; the first as soon as it is needed
  Suggestions found_;

  Settings& held() { return found_.suggested; }

  /// Without, the rate is a fact that the configuration states, and no choice.
  bool has_times() const { return !options_.data.time.empty(); }

  double wanted_hz() const { return check_.advice.rate.rate_hz; }
  double present_hz() const {
    return found_.present.rate_hz > 0.0 ? found_.present.rate_hz : check_.advice.rate_facts.inputs_hz;
  }

  /// Of the two rates that may be compared the slower one's period.
  double common_time_s() const {
    return 1.0 / (wanted_hz() > 0.0 ? std::min(wanted_hz(), present_hz()) : present_hz());
  }

  /// Whether refinement has random starts, which take half of the time or more.
  bool has_random_starts() const {
    return options_.bank.em.restarts > 0 && chain_inputs(options_).bank.bank.refine == Refine::em;
  }

  LeftOut predict(const Settings& settings, bool random_starts) const {
    const Stopwatch watch;
    ChainOptions options = with_settings(options_, settings);
    if (!random_starts) options.bank.em.restarts = 0;
    LeftOut left_out = predict_left_out(options, plan_, common_s_);
    listener_.progress(
        fmt::format("check: rate {}, lag {}, length {}, loss {} scored on {} training runs left out in {:.2f} s",
                    settings.rate_hz > 0.0 ? fmt::format("{:g} Hz", settings.rate_hz) : "as recorded",
                    settings.lag_auto ? "auto" : fmt::format("{:g} s", settings.lag_s), settings.window_length,
                    name_of(settings.loss), plan_.runs.size(), watch.seconds()));
    return left_out;
  }

  DataCheck checked(const Settings& settings, double lag_s) const {
    ChainOptions options = with_settings(options_, settings);
    options.data.lag_auto = false;
    options.data.lag_s = lag_s;
    return check_data(check_options(options));
  }

  void attempt(Change change, const Settings& to, const Advice& advice) {
    Trial trial{change, held(), to, advice, {}, {}, false};
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
      trial.unscored = "too few predictions of the same samples to compare";
  }

  /// What gained without random starts must gain with them: else it made up for an optimum that `run` does not end in.
  void confirm(LeftOut said, Trial& trial) {
    const bool again = has_random_starts();
    if (whole_.empty()) whole_.push_back(again ? predict(found_.present, true) : held_.front());
    LeftOut whole = again ? predict(trial.to, true) : said;
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
    DataCheck then = checked(to, to.lag_s);
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
    Trial unscored{Change::lag, held(), to, check_.advice, {}, "fewer than three training runs", false};
    if (plan_.parts.empty()) return found_.trials.push_back(unscored);  // their own lag would be known
    attempt(Change::lag, to, check_.advice);
    if (found_.trials.back().accepted) check_ = checked(to, check_.lag.lag.mean);
  }

  void try_length() {
    const bool with_rate = held().rate_hz != found_.present.rate_hz;  // chosen together
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

Settings settings_of(const ChainOptions& options) {
  return {options.data.rate_hz,  options.data.lag_auto, options.data.lag_s,
          options.window.length, options.window.step,   options.window.loss};
}

ChainOptions with_settings(ChainOptions options, const Settings& settings) {
  options.data.rate_hz = settings.rate_hz;
  options.data.lag_auto = settings.lag_auto;
  options.data.lag_s = settings.lag_s;
  options.window.length = settings.window_length;
  options.window.step = settings.window_step;
  options.window.loss = settings.loss;
  return options;
}

bool Suggestions::any() const {
  return std::any_of(trials.begin(), trials.end(), [](const Trial& trial) { return trial.accepted; });
}

Suggestions suggest(const ChainOptions& options, const DataCheck& check, const Listener& listener) {
  return Search(options, check, listener).run();
}

}  // namespace modebank
