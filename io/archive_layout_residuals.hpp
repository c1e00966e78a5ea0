#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "io/archive.hpp"
#include "io/archive_sizes.hpp"

/// The layout of residual tests; see archive_layout.hpp. T lags, from 0 on.
namespace modebank::layout {

template <class Io, class R>
void exchange_run_residuals(Io& io, R& tests) {
  io.attribute("samples", tests.samples);
  io.attribute("level", tests.level);
  io.attribute("autocorrelation_band", tests.autocorrelation_band);
  io.field("autocorrelation", tests.autocorrelation, {"T", "n"});
  io.field("cross_correlation", tests.cross_correlation, {"T", "n", "m"});
  io.field("cross_correlation_band", tests.cross_correlation_band, {"n", "m"});
  io.field("ljung_box_p", tests.ljung_box_p, {"n"});
}

/// residual_tests/<model>/<run>/, every run of the recording in its order.
template <class Io, class S>
void exchange_residual_tests(Io& io, S& sets, const Recording& recording) {
  const auto names = [](const std::vector<ResidualTestSet>& list) {
    std::vector<std::string> models;
    for (const ResidualTestSet& set : list) models.push_back(set.model);
    return models;
  };
  const auto named = [](const std::vector<std::string>& models) {
    std::vector<ResidualTestSet> list;
    for (const std::string& model : models) list.push_back({model, {}});
    return list;
  };
  io.through(sets, names, named, [&](auto& models) { io.attribute_texts("models", models); });
  Sizes known;
  known.set("n", recording.states.size());
  known.set("m", recording.inputs.size());
  for (auto& set : sets)
    io.group(set.model, {}, [&](auto& member) {
      if constexpr (Io::reads) set.runs.resize(recording.runs.size());
      if (set.runs.size() != recording.runs.size())
        throw std::invalid_argument("residual tests of " + std::to_string(set.runs.size()) + " runs of " +
                                    std::to_string(recording.runs.size()));
      for (std::size_t i = 0; i < recording.runs.size(); ++i)
        member.group(recording.runs[i].run, known, [&](auto& run) { exchange_run_residuals(run, set.runs[i]); });
    });
}

}  // namespace modebank::layout
