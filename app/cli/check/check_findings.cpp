#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/cli/check/check_output.hpp"
#include "app/text/text_units.hpp"

namespace modebank::app {
namespace {

constexpr std::size_t most_names = 8;

/// Names of the runs that meet a condition, for example "00, 03 and 5 more"; empty if there is none.
std::string runs_where(const DataCheck& check, const std::function<bool(const RunReport&)>& condition) {
  std::vector<std::string> names;
  for (const RunReport& run : check.runs)
    if (condition(run)) names.push_back(run.run);
  const std::size_t shown = std::min(names.size(), most_names);
  std::string text =
      fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  return names.size() > shown ? text + fmt::format(" and {} more", names.size() - shown) : text;
}

/// A count of both streams, over all runs.
Index total(const DataCheck& check, Index SamplingCheck::*count) {
  Index sum = 0;
  for (const RunReport& run : check.runs) sum += run.inputs.*count + run.states.*count;
  return sum;
}

/// Names of the runs in which one of the counts is not 0 for a stream.
std::string runs_with(const DataCheck& check, const std::vector<Index SamplingCheck::*>& counts) {
  return runs_where(check, [&](const RunReport& run) {
    return std::ranges::any_of(counts, [&](auto count) { return run.inputs.*count + run.states.*count > 0; });
  });
}

void time_findings(const DataCheck& check, const Config& config, std::vector<std::string>& found) {
  const auto add = [&](bool accepted, const std::string& text, const std::string& mend) {
    found.push_back(text + (accepted ? " (accepted as configured)" : ": " + mend));
  };
  constexpr auto repeated = &SamplingCheck::repeated_times, backward = &SamplingCheck::backward_times,
                 missing = &SamplingCheck::missing_samples;
  if (const auto runs = runs_with(check, {repeated, backward}); !runs.empty())
    add(config.data.disorder == Disorder::sort,
        fmt::format("time repeats {} times and goes backwards {} times in {}", total(check, repeated),
                    total(check, backward), runs),
        "data.disorder = sort accepts it");
  if (const auto runs = runs_with(check, {missing}); !runs.empty())
    add(config.data.missing != Missing::error,
        fmt::format("{} samples miss a value in {}", total(check, missing), runs),
        "data.missing = gap or predict accepts them");
  if (const auto runs = runs_with(check, {&SamplingCheck::missing_times}); !runs.empty())
    found.push_back(
        fmt::format("samples without a time in {}; remove these rows, since no setting accepts them", runs));
  if (const auto runs = runs_with(check, {&SamplingCheck::gaps}); !runs.empty())
    found.push_back(fmt::format("gaps of more than 5 periods in {}, which split these runs", runs));
  const auto scatters = [](const RunReport& r) { return r.inputs.jitter > most_step_scatter; };
  if (const auto runs = runs_where(check, scatters); !runs.empty()) {
    double worst = 0.0;
    for (const RunReport& run : check.runs) worst = std::max(worst, run.inputs.jitter);
    found.push_back(
        fmt::format("steps scatter by up to {:.0f} % of their median in {}, but a model has one step length. Other "
                    "lengths look like modes, so modes are not judged; log at an even rate",
                    percent * worst, runs));
  }
}

/// Joint excitation of the inputs in the run with the lowest value; empty if the value is missing for some run.
std::string excitation_words(const DataCheck& check) {
  Index least = check.runs.empty() ? 0 : check.runs.front().excitation;
  for (const RunReport& run : check.runs) least = std::min(least, run.excitation);
  if (least < 1) return "";
  return fmt::format(", and the inputs are persistently exciting of order {}{} in every run", least,
                     least < most_excitation_order ? "" : " or more");
}

void channel_findings(const DataCheck& check, std::vector<std::string>& found) {
  for (std::size_t i = 0; i < check.channels.size(); ++i) {
    const ChannelSummary& channel = check.channels[i];
    const std::size_t states = check.runs.empty() ? 0 : check.runs.front().state.size();
    if (channel.saturated > 0.0)
      found.push_back(
          fmt::format("{} {} ({:.1f} % of samples; range {:.4g} to {:.4g}) in {}: possibly a limiter, whose effect the "
                      "model does not include",
                      channel.channel.name,
                      channel.limits.soft ? "crowds towards the end of its range" : "piles up at the end of its range",
                      percent * channel.saturated, channel.values.least, channel.values.largest,
                      runs_where(check, [&](const RunReport& run) {
                        return (channel.is_state ? run.state_saturated[i] : run.input_saturated[i - states]) > 0.0;
                      })));
    if (channel.values.quantum > 0.0)
      found.push_back(fmt::format("{} comes in multiples of {:.6g}{}", channel.channel.name, channel.values.quantum,
                                  channel.is_state ? "; the rounding error is a third of that. data.quantum = auto "
                                                     "adds it to R if that is coarse against the noise"
                                                   : ""));
    if (channel.values.levels == 1)
      found.push_back(fmt::format("{} is constant: {:g} in every sample", channel.channel.name, channel.values.least));
    else if (channel.values.two_level)
      found.push_back(fmt::format("{} is a binary signal: it switches between two levels (range {:.4g} to {:.4g}){}",
                                  channel.channel.name, channel.values.least, channel.values.largest,
                                  channel.is_state ? "" : excitation_words(check)));
    else if (channel.repeated > 0.3 && (channel.is_state || channel.values.quantum == 0.0))
      found.push_back(fmt::format("{} repeats {:.0f} % of its samples in motion, so its source is slower than the file",
                                  channel.channel.name, percent * channel.repeated));
    if (channel.is_state && channel.values.outliers > 0)
      found.push_back(fmt::format("{} has {} isolated spikes", channel.channel.name, channel.values.outliers));
  }
}

void rest_findings(const DataCheck& check, std::vector<std::string>& found) {
  std::size_t named = 0;
  for (const RunReport& run : check.runs)
    for (Index i = 0; i < run.rest.mean.size(); ++i)
      if (std::isfinite(run.rest.mean(i)) && ++named <= most_names)
        found.push_back(fmt::format("run {}: {} is {:.3g} (sd {:.2g}) at rest ({:.1f} s)", run.run,
                                    check.channels[static_cast<std::size_t>(i)].channel.name, run.rest.mean(i),
                                    run.rest.sd(i), run.rest.duration_s));
}

void excitation_findings(const DataCheck& check, std::vector<std::string>& found) {
  constexpr double many = 0.5;
  Index windows = 0, deficient = 0;
  for (const RunReport& run : check.runs) {
    windows += run.windows.windows;
    deficient += run.windows.deficient;
  }
  if (windows > 0 && static_cast<double>(deficient) > many * static_cast<double>(windows))
    found.push_back(fmt::format(
        "{:.0f} % of the windows are rank deficient: keep window.prior = global, and read `information` before theta",
        percent * static_cast<double>(deficient) / static_cast<double>(windows)));
  if (const auto runs =
          runs_where(check, [](const RunReport& run) { return run.excitation < 1 && !run.input.empty(); });
      !runs.empty())
    found.push_back(fmt::format("inputs are zero or proportional to each other throughout {}", runs));
}

void lag_findings(const DataCheck& check, const Config& config, std::vector<std::string>& found) {
  if (!check.has_lag) return;
  if (check.lag.correction != LagCorrection::none && !config.data.lag_auto && config.data.lag_s == 0.0) {
    const auto score = std::find_if(check.lag.scores.begin(), check.lag.scores.end(),
                                    [&](const LagScore& s) { return s.correction == check.lag.correction; });
    found.push_back(
        fmt::format("the inputs act {:+.3f} +- {:.3f} s after their stamps; with this corrected the global model gains "
                    "{:.3f} +- {:.3f} nats/transition on training runs left out",
                    check.lag.lag.mean, check.lag.lag.standard_error, score->gain, score->gain_standard_error));
  }
}

}  // namespace

std::string unusable_text(const DataCheck& check) {
  const bool too_short = !check.unusable.empty() && check.longest_stretch < check.window_length;
  return check.unusable + (too_short ? fmt::format("; window.length is {}", check.window_length) : "");
}

std::vector<std::string> findings_of(const DataCheck& check, const Config& config) {
  std::vector<std::string> found;
  if (!check.unusable.empty()) found.push_back("UNUSABLE as configured: " + unusable_text(check));
  time_findings(check, config, found);
  found.insert(found.end(), check.dominating.begin(), check.dominating.end());
  channel_findings(check, found);
  rest_findings(check, found);
  excitation_findings(check, found);
  if (!check.unidentifiable_effects.empty()) found.push_back(check.unidentifiable_effects);
  lag_findings(check, config, found);
  return found;
}

}  // namespace modebank::app
