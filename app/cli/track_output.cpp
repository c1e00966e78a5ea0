#include "app/cli/track_output.hpp"

#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "ident/base/printable.hpp"
#include "io/files/csv_field.hpp"

namespace modebank::app {

namespace {

using Eigen::Index;

/// the names of the flags, in the order of the columns
constexpr std::array<std::pair<const char*, bool ValidityFlags::*>, 4> flag_names{
    {{"warming_up", &ValidityFlags::warming_up},
     {"input_beyond_training", &ValidityFlags::input_beyond_training},
     {"unlike_any_mode", &ValidityFlags::unlike_any_mode},
     {"stamp_late", &ValidityFlags::stamp_late}}};

void number(fmt::memory_buffer& out, double value, const char* unknown) {
  if (std::isfinite(value))
    fmt::format_to(std::back_inserter(out), "{}", value);
  else
    fmt::format_to(std::back_inserter(out), "{}", unknown);
}

Index likeliest(const FilterEstimate& estimate) {
  Index mode = 0;
  estimate.mode_probability.maxCoeff(&mode);
  return mode;
}

/// JSON is UTF-8, but names in an archive may contain other bytes.
std::string json_quoted(const std::string& name) { return nlohmann::json(printable_name(name)).dump(); }

}  // namespace

EstimateWriter::EstimateWriter(std::vector<std::string> states, Index modes, const EstimateLines& lines)
    : states_(std::move(states)), modes_(modes), lines_(lines) {
  for (std::string& state : states_) state = lines_.json ? json_quoted(state) : printable_name(state);
}

void EstimateWriter::header(fmt::memory_buffer& out) const {
  if (lines_.json) return;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "{}time,steps", lines_.run ? "run," : "");
  for (const std::string& s : states_)
    for (const char* what : {"_predicted", "_lower", "_upper", "", "_sd"})
      fmt::format_to(to, ",{}", csv_field(s + what));
  fmt::format_to(to, ",nis,log_density,alarm");
  for (const auto& [name, flag] : flag_names) fmt::format_to(to, ",{}", name);
  fmt::format_to(to, ",mode");
  for (Index j = 0; j < modes_; ++j) fmt::format_to(to, ",p{}", j);
  fmt::format_to(to, "\n");
}

/// The numbers of a state, as CSV fields or as a JSON object with the state's name.
void EstimateWriter::signal(std::size_t state, std::initializer_list<double> values,
                            std::initializer_list<const char*> names, fmt::memory_buffer& out) const {
  auto to = std::back_inserter(out);
  if (lines_.json) fmt::format_to(to, ",{}:{{", states_[state]);
  const char* const* name = names.begin();
  for (const double value : values) {
    if (lines_.json)
      fmt::format_to(to, "{}\"{}\":", name == names.begin() ? "" : ",", *name);
    else
      fmt::format_to(to, ",");
    number(out, value, lines_.json ? "null" : "");
    ++name;
  }
  if (lines_.json) fmt::format_to(to, "}}");
}

void EstimateWriter::line(const std::string& run, double time_s, const FilterEstimate& e, const LiveVerdict& verdict,
                          const ValidityFlags& flags, fmt::memory_buffer& out) const {
  auto to = std::back_inserter(out);
  const bool as_json = lines_.json;
  const auto named = [&](const char* name, double value) {
    fmt::format_to(to, fmt::runtime(as_json ? ",\"{}\":" : ","), name);
    number(out, value, as_json ? "null" : "");
  };
  if (as_json) fmt::format_to(to, "{{");
  if (lines_.run && as_json) fmt::format_to(to, "\"run\":{},", json_quoted(run));
  if (lines_.run && !as_json) fmt::format_to(to, "{},", csv_field(run));
  fmt::format_to(to, fmt::runtime(as_json ? "\"time\":{},\"steps\":{}" : "{},{}"), time_s, e.steps);
  for (std::size_t s = 0; s < states_.size(); ++s) {
    const auto i = static_cast<Index>(s);
    signal(s, {verdict.predicted(i), verdict.lower(i), verdict.upper(i), e.state(i), std::sqrt(e.covariance(i, i))},
           {"predicted", "lower", "upper", "estimate", "sd"}, out);
  }
  named("nis", e.nis);
  named("log_density", e.log_density);
  fmt::format_to(to, fmt::runtime(as_json ? ",\"alarm\":{}" : ",{:d}"), verdict.alarm);
  for (const auto& [name, flag] : flag_names)
    as_json ? fmt::format_to(to, ",\"{}\":{}", name, flags.*flag) : fmt::format_to(to, ",{:d}", flags.*flag);
  fmt::format_to(to, fmt::runtime(as_json ? ",\"mode\":{}" : ",{}"), likeliest(e));
  if (as_json) fmt::format_to(to, ",\"probability\":[");
  for (Index j = 0; j < modes_; ++j) {
    if (!as_json || j > 0) fmt::format_to(to, ",");
    number(out, e.mode_probability(j), as_json ? "null" : "");
  }
  if (as_json) fmt::format_to(to, "]");
  fmt::format_to(to, fmt::runtime(as_json ? "}}\n" : "\n"));
}

}  // namespace modebank::app
