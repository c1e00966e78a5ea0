#include <fmt/format.h>

#include "app/report/page/numbers.hpp"
#include "app/report/page/run_sections.hpp"
#include "mixture/criteria.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

json candidate_row(const Candidate& c) {
  json row = {{"components", c.components},
              {"covariance", name_of(c.covariance)},
              {"status", name_of(c.status)},
              {"failed", c.failed},
              {"selected", c.selected}};
  if (c.status != CandidateStatus::fitted) return row;
  row["log_likelihood"] = number(c.log_likelihood, fmt::format("{:.3f}", c.log_likelihood));
  row["parameters"] = count(c.parameters);
  row["effective_samples"] = number(c.effective_samples, fmt::format("{:.1f}", c.effective_samples));
  for (const auto& [name, value] : {std::pair{"bic", c.bic}, {"aic", c.aic}, {"bic_naive", c.bic_naive}})
    row[name] = std::isnan(value) ? number(value) : number(value, fmt::format("{:.2f}", value));
  row["iterations"] = count(c.iterations);
  row["converged"] = c.converged ? "yes" : "no";
  row["agreeing"] = {{"t", fmt::format("{} of {}", c.agreeing_restarts, c.restarts)}, {"v", c.agreeing_restarts}};
  row["restarts"] = c.restarts;
  row["floor_active"] = c.floor_active;
  return row;
}

}  // namespace

nlohmann::json selection_section(const Archive& archive) {
  if (!archive.mixture) return nullptr;
  json rows = json::array();
  for (const Candidate& candidate : archive.mixture->candidates) rows.push_back(candidate_row(candidate));
  return {{"candidates", rows}, {"warnings", selection_warnings(archive.mixture->candidates)}};
}

}  // namespace modebank::app::report
