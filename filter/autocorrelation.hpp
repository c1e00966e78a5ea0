#pragma once

#include <vector>

namespace modebank {

/// Run by run, in the order of time.
using SeriesByRun = std::vector<std::vector<double>>;

double sample_count(const SeriesByRun& series);

/// Mean over all values; NaN without any.
double mean_of(const SeriesByRun& series);

/// Autocorrelation time: variance of the mean over that of as many independent terms, at least 1 (initial positive
/// sequence of Geyer 1992, Statistical Science 7). NaN without values.
double autocorrelation_time(const SeriesByRun& series);

/// The same of the series that is 1 where a value is among the largest 2.5 % (or smallest), else 0, without looking at
/// these few: from the autocorrelations of all values' normal scores, as if these were jointly normal (the tetrachoric
/// series of Pearson 1900). NaN without values.
double autocorrelation_time_of_tail(const SeriesByRun& series);

/// An autocorrelation time that `samples` samples showed, what it is above 1 raised by the time's relative standard
/// error (Madras & Sokal 1988, Journal of Statistical Physics 50; as if lags up to twice the time entered).
double cautious_time(double time, double samples);

}  // namespace modebank
