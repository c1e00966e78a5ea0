#include "app/cli/track_output.hpp"

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "ident/base/printable.hpp"
#include "io/files/csv_field.hpp"

namespace modebank::app {

namespace {

using Eigen::Index;

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

/// JSON is UTF-8; a name from an archive may hold other bytes.
std::string json_quoted(const std::string& name) { return nlohmann::json(printable_name(name)).dump(); }

}  // namespace

EstimateWriter::EstimateWriter(std::vector<std::string> states, Index modes, bool as_json)
    : states_(std::move(states)), modes_(modes), json_(as_json) {
  for (std::string& state : states_) state = json_ ? json_quoted(state) : printable_name(state);
}

void EstimateWriter::header(fmt::memory_buffer& out) const {
  if (json_) return;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "time,steps");
  for (const std::string& s : states_)
    for (const char* what : {"_predicted", "_lower", "_upper", "", "_sd"})
      fmt::format_to(to, ",{}", csv_field(s + what));
  fmt::format_to(to, ",nis,log_density,alarm,mode");
  for (Index j = 0; j < modes_; ++j) fmt::format_to(to, ",p{}", j);
  fmt::format_to(to, "\n");
}

void EstimateWriter::line(double time_s, const FilterEstimate& e, const LiveVerdict& verdict,
                          fmt::memory_buffer& out) const {
  auto to = std::back_inserter(out);
  const char* unknown = json_ ? "null" : "";
  const auto named = [&](const char* name, double value) {
    fmt::format_to(to, fmt::runtime(json_ ? ",\"{}\":" : ","), name);
    number(out, value, unknown);
  };
  fmt::format_to(to, fmt::runtime(json_ ? "{{\"time\":{},\"steps\":{}" : "{},{}"), time_s, e.steps);
  for (std::size_t s = 0; s < states_.size(); ++s) {
    const auto i = static_cast<Index>(s);
    if (json_) fmt::format_to(to, ",{}:{{", states_[s]);
    const double values[] = {verdict.predicted(i), verdict.lower(i), verdict.upper(i), e.state(i),
                             std::sqrt(e.covariance(i, i))};
    const char* names[] = {"predicted", "lower", "upper", "estimate", "sd"};
    for (std::size_t k = 0; k < std::size(values); ++k) {
      if (json_)
        fmt::format_to(to, "{}\"{}\":", k == 0 ? "" : ",", names[k]);
      else
        fmt::format_to(to, ",");
      number(out, values[k], unknown);
    }
    if (json_) fmt::format_to(to, "}}");
  }
  named("nis", e.nis);
  named("log_density", e.log_density);
  fmt::format_to(to, fmt::runtime(json_ ? ",\"alarm\":{},\"mode\":{}" : ",{:d},{}"), verdict.alarm, likeliest(e));
  if (json_) fmt::format_to(to, ",\"probability\":[");
  for (Index j = 0; j < modes_; ++j) {
    if (!json_ || j > 0) fmt::format_to(to, ",");
    number(out, e.mode_probability(j), unknown);
  }
  fmt::format_to(to, fmt::runtime(json_ ? "]}}\n" : "\n"));
}

}  // namespace modebank::app
