#pragma once

#include "ident/lag_report.hpp"
#include "io/table_columns.hpp"

/// What data.lag_s = auto found: the part of the archive's layout under /lag (io/archive_layout.hpp).
namespace modebank::layout {

template <class Io, class P>
void exchange_pooled(Io& io, const std::string& name, P& pooled) {
  io.attribute(name, pooled.mean);
  io.attribute(name + "_standard_error", pooled.standard_error);
  io.attribute(name + "_between_runs_sd", pooled.between_sd);
  io.attribute(name + "_runs", pooled.count);
}

template <class Io, class L>
void exchange_lag(Io& io, L& lag) {
  io.attribute("correction", lag.correction);
  exchange_pooled(io, "lag_s", lag.lag);
  exchange_pooled(io, "start_lag_s", lag.start_lag);
  exchange_pooled(io, "clock_drift", lag.drift);
  io.table("scores", lag.scores, column("correction", &LagScore::correction),
           column("transitions", &LagScore::transitions), column("log_score", &LagScore::log_score, "nat"),
           column("rmse", &LagScore::rmse), column("gain", &LagScore::gain, "nat"),
           column("gain_standard_error", &LagScore::gain_standard_error, "nat"));
  io.table("runs", lag.runs, column("run", &RunLag::run), column("status", &RunLag::status),
           column("lag_s", &RunLag::lag_s, "s"), column("lag_standard_error_s", &RunLag::lag_standard_error_s, "s"),
           column("time_constant_s", &RunLag::time_constant_s, "s"), column("r_squared", &RunLag::r_squared),
           column("drift_status", &RunLag::drift_status), column("drifting_lag_s", &RunLag::drifting_lag_s, "s"),
           column("drifting_lag_standard_error_s", &RunLag::drifting_lag_standard_error_s, "s"),
           column("clock_drift", &RunLag::clock_drift),
           column("clock_drift_standard_error", &RunLag::clock_drift_standard_error),
           column("match_s", &RunLag::match_s, "s"), column("match_least_s", &RunLag::match_least_s, "s"),
           column("match_largest_s", &RunLag::match_largest_s, "s"), column("match_windows", &RunLag::match_windows),
           column("applied_lag_s", &RunLag::applied_lag_s, "s"),
           column("applied_clock_drift", &RunLag::applied_clock_drift),
           column("applied_reference_s", &RunLag::applied_reference_s, "s"));
}

}  // namespace modebank::layout
