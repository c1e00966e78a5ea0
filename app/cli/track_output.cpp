#include "app/cli/track_output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "io/files/csv_field.hpp"

namespace modebank::app {

namespace {

using Eigen::Index;

/// Number of predictions before a filter has settled. Mean log scores of predictions 1 to 5, 6 to 10 and 11 to 30 of a
/// run:
/// - DRIVE (201 runs): 1.27, 1.41, 1.46
/// - ICE (24): 2.34, 2.76, 3.15
/// - FLOORING (16): 2.19, 2.39, 2.66
constexpr Index unsettled_samples = 10;

/// Tail probability on either side, under the mixture of all modes. The flag is not set if even one mode with
/// probability 0.001 predicts the measurement. On held-out runs the flag is set for 0 of 5,533 samples of ICE, 1 of
/// 10,300 of DRIVE, 3 of 7,138 of FLOORING.
constexpr double unlike_tail = 1e-6;

/// the names of the flags, in the order of the columns
constexpr std::array<std::pair<const char*, bool ValidityFlags::*>, 4> flag_names{
    {{"warming_up", &ValidityFlags::warming_up},
     {"input_beyond_training", &ValidityFlags::input_beyond_training},
     {"unlike_any_mode", &ValidityFlags::unlike_any_mode},
     {"stamp_late", &ValidityFlags::stamp_late}}};

/// JSON is UTF-8, but names in an archive may contain other bytes.
std::string json_quoted(const std::string& name) { return nlohmann::json(printable_name(name)).dump(); }

/// Appends the fields of a line: bare values in CSV, in NDJSON members with their names, if they have one.
struct FieldWriter {
  fmt::memory_buffer& out;
  bool json, first = true;

  template <class... Values>
  void text(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(out), form, std::forward<Values>(values)...);
  }
  void begin(const char* name) {
    if (!std::exchange(first, false)) text(",");
    if (json && name != nullptr) text("\"{}\":", name);
  }
  template <class Value>
  void field(const char* name, const Value& value) {
    begin(name);
    text("{}", value);
  }
  void number(const char* name, double value) {
    begin(name);
    if (std::isfinite(value))
      text("{}", value);
    else if (json)
      text("null");
  }
  void flag(const char* name, bool value) { json ? field(name, value) : field(name, value ? 1 : 0); }
};

}  // namespace

ValidityFlags ValidityJudge::judge(double time_s, const Eigen::VectorXd& input, const FilterEstimate& estimate,
                                   bool started) {
  ValidityFlags flags;
  if (samples_ > 0) {
    const Index steps = SampleFeed::steps_between(last_s_, time_s, dt_s_);
    flags.stamp_late = steps > 1;
    if (steps > longest_gap_steps) restart();
  }
  last_s_ = time_s;
  ++samples_;
  flags.warming_up = !started || samples_ <= lags_ + unsettled_samples;
  // A missing input is a repeated value, which was judged when it arrived.
  for (Index i = 0; i < std::min(input.size(), trained_.least.size()); ++i)
    if (input(i) < trained_.least(i) || input(i) > trained_.largest(i)) flags.input_beyond_training = true;
  // Comparisons with NaN (a missing signal) are false.
  flags.unlike_any_mode = ((estimate.pit.array() - 0.5).abs() > 0.5 - unlike_tail).any();
  return flags;
}

EstimateWriter::EstimateWriter(std::vector<std::string> states, Index modes, const EstimateLines& lines)
    : states_(std::move(states)), modes_(modes), lines_(lines) {
  for (std::string& state : states_) state = lines_.json ? json_quoted(state) : printable_name(state);
}

void EstimateWriter::header(fmt::memory_buffer& out) const {
  if (lines_.json) return;
  FieldWriter to{out, false};
  if (lines_.run) to.field("", "run");
  for (const char* name : {"time", "steps"}) to.field("", name);
  for (const std::string& s : states_)
    for (const char* what : {"_predicted", "_lower", "_upper", "", "_sd"}) to.field("", csv_field(s + what));
  for (const char* name : {"nis", "log_density", "alarm"}) to.field("", name);
  for (const auto& [name, flag] : flag_names) to.field("", name);
  to.field("", "mode");
  for (Index j = 0; j < modes_; ++j) to.field("", fmt::format("p{}", j));
  to.text("\n");
}

void EstimateWriter::line(const std::string& run, double time_s, const FilterEstimate& e, const LiveVerdict& verdict,
                          const ValidityFlags& flags, fmt::memory_buffer& out) const {
  const bool json = lines_.json;
  FieldWriter to{out, json};
  if (json) to.text("{{");
  if (lines_.run) to.field("run", json ? json_quoted(run) : csv_field(run));
  to.field("time", time_s);
  to.field("steps", e.steps);
  for (std::size_t s = 0; s < states_.size(); ++s) {
    const auto i = static_cast<Index>(s);
    if (json) {
      to.text(",{}:{{", states_[s]);
      to.first = true;
    }
    to.number("predicted", verdict.predicted(i));
    to.number("lower", verdict.lower(i));
    to.number("upper", verdict.upper(i));
    to.number("estimate", e.state(i));
    to.number("sd", std::sqrt(e.covariance(i, i)));
    if (json) to.text("}}");
  }
  to.number("nis", e.nis);
  to.number("log_density", e.log_density);
  to.flag("alarm", verdict.alarm);
  for (const auto& [name, flag] : flag_names) to.flag(name, flags.*flag);
  Index mode = 0;
  e.mode_probability.maxCoeff(&mode);
  to.field("mode", mode);
  if (json) to.text(",\"probability\":[");
  to.first = json;
  for (Index j = 0; j < modes_; ++j) to.number(nullptr, e.mode_probability(j));
  if (json) to.text("]}}");
  to.text("\n");
}

}  // namespace modebank::app
