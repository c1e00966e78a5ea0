#include "app/text/free_run_text.hpp"

#include <fmt/format.h>

#include "app/text/number_text.hpp"
#include "app/text/text_table.hpp"

namespace modebank::app {
namespace {

/// Text such as "95.1 94.8": one number for each state.
std::string percents(const Eigen::VectorXd& shares) { return size_list((100.0 * shares).eval(), 1); }

std::string caption(const Archive& archive) {
  return fmt::format("\nFree run: {} measured samples at the beginning, then inputs alone; by {}\n",
                     archive.free_runs.front().start,
                     archive.bank && !archive.bank->transition_logit.empty()
                         ? "sample paths (log score: of a Gaussian per mode; other filters: by moments)"
                         : "the modes' moments (each mode taken for a Gaussian)");
}

}  // namespace

std::string free_run_text(const Archive& archive, int width) {
  if (archive.free_runs.empty()) return "";
  using Align = TextTable::Align;
  TextTable table({{"filter", 11, Align::left},
                   {"role", 5, Align::left},
                   {"samples", 8},
                   {"log score", 10},
                   {"RMSE", 10},
                   {"NRMSE", 8},
                   {"FIT %", 8},
                   {"in 50 %", 8},
                   {"90 %", 6},
                   {"95 % band", 9}},
                  2);
  Index lost = 0;
  for (const FreeRunRow& row : archive.free_runs) {
    if (row.run != "*") continue;
    lost += row.lost_paths;
    table.add({row.filter, std::string(name_of(row.role)), std::to_string(row.samples),
               fixed_or_short(row.log_score, 4), size_list(row.rmse, 5), size_list(row.nrmse, 3), size_list(row.fit, 1),
               percents(row.coverage_50), percents(row.coverage_90), percents(row.coverage_95)});
  }
  const std::string text = caption(archive) + table.text(width);
  return lost == 0 ? text : text + fmt::format("{} sample paths left the finite range and were taken out\n", lost);
}

}  // namespace modebank::app
