#include "app/text/lag_counts_text.hpp"

#include <fmt/format.h>

#include <utility>

namespace modebank::app {

std::string lag_counts_text(const LagCounts& found) {
  using Count = std::ptrdiff_t LagCountScore::*;
  std::string text;
  for (const auto& [varied, count] : {std::pair<const char*, Count>{"state_lags", &LagCountScore::state_lags},
                                      {"input_lags", &LagCountScore::input_lags}}) {
    std::string scores, chosen;
    std::ptrdiff_t samples = 0;
    for (const LagCountScore& score : found.scores) {
      if (score.varied != varied) continue;
      samples = score.samples;
      if (score.chosen) chosen = fmt::format("{}", score.*count);
      scores += fmt::format("{}{}: {:.4f}", scores.empty() ? "" : ", ", score.*count, score.log_score);
      if (score.loss != 0.0)
        scores += fmt::format(" ({:.4f} +- {:.4f} below the best)", score.loss, score.loss_standard_error);
    }
    if (scores.empty()) continue;
    text += fmt::format(
        "lags      {} = {}: the fewest within one standard error of the best; log score on training runs left out, {} "
        "samples: {}\n",
        varied, chosen, samples, scores);
  }
  return text;
}

}  // namespace modebank::app
