#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "app/chain/learn_left_out.hpp"
#include "app/chain/stages.hpp"
#include "filter/judge/paired_gain.hpp"
#include "ident/base/not_a_number.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Eigen::VectorXd;

constexpr Index most_parts = 3;  // each is a chain of its own

/// One number of lags, with what it predicted run by run.
struct Candidate {
  LagCountScore score;
  std::vector<VectorXd> log_densities;
};

class LagSearch {
 public:
  LagSearch(const Recording& recording, const LagCountInputs& inputs, const Listener& listener)
      : inputs_(inputs), listener_(listener), splits_(validation_splits(recording, most_parts)) {
    if (splits_.empty())
      throw DataError("the number of lags cannot be found by cross-validation: there is nothing to leave out");
    const FitOptions& window = inputs.learning.bank.window;
    // States first, beside as many inputs as there may be: a lag of the state must not make up for one of the input.
    found_ = {window.state_lags, inputs.automatic.input ? most_automatic_lags : window.input_lags, {}};
  }

  LagCounts run() {
    if (inputs_.automatic.state) choose("state_lags", &LagCounts::state_lags, &LagCountScore::state_lags);
    if (inputs_.automatic.input) choose("input_lags", &LagCounts::input_lags, &LagCountScore::input_lags);
    return found_;
  }

 private:
  const LagCountInputs& inputs_;
  const Listener& listener_;
  std::vector<ValidationSplit> splits_;
  LagCounts found_;
  std::map<std::pair<std::ptrdiff_t, std::ptrdiff_t>, std::vector<VectorXd>> known_;  ///< by lags of state and inputs

  void choose(const std::string& varied, std::ptrdiff_t LagCounts::*found, std::ptrdiff_t LagCountScore::*counted) {
    std::vector<Candidate> candidates;
    for (Index count = 1; count <= most_automatic_lags; ++count) {
      LagCounts tried = found_;
      tried.*found = count;
      auto& said = known_[{tried.state_lags, tried.input_lags}];
      if (said.empty()) said = predictions(tried);
      candidates.push_back({{varied, tried.state_lags, tried.input_lags}, said});
    }
    keep_common_samples(candidates);
    score(candidates);
    const auto chosen = std::find_if(candidates.begin(), candidates.end(), [](const Candidate& c) {
      return !(c.score.loss > std::max(c.score.loss_standard_error, RefineTuning{}.least_gain));
    });
    chosen->score.chosen = true;
    found_.*found = chosen->score.*counted;
    for (Candidate& candidate : candidates) found_.scores.push_back(std::move(candidate.score));
  }

  std::vector<VectorXd> predictions(const LagCounts& tried) const {
    const Stopwatch watch;
    LearningInputs learning = inputs_.learning;
    learning.bank.window.state_lags = tried.state_lags;
    learning.bank.window.input_lags = tried.input_lags;
    std::vector<VectorXd> said;
    for (std::vector<LeftOutRun>& part : predict_left_out(splits_, learning, 0))
      for (LeftOutRun& run : part) said.push_back(std::move(run.one_step));
    listener_.progress(
        fmt::format("lags: {} of the state, {} of the inputs scored on training runs left out in {:.2f} s",
                    tried.state_lags, tried.input_lags, watch.seconds()));
    return said;
  }

  /// More lags start later in a run: what one of the candidates has not predicted counts for none.
  static void keep_common_samples(std::vector<Candidate>& candidates) {
    for (std::size_t run = 0; run < candidates.front().log_densities.size(); ++run)
      for (Index k = 0; k < candidates.front().log_densities[run].size(); ++k)
        if (std::any_of(candidates.begin(), candidates.end(),
                        [&](const Candidate& c) { return std::isnan(c.log_densities[run](k)); }))
          for (Candidate& candidate : candidates) candidate.log_densities[run](k) = not_a_number;
  }

  static void score(std::vector<Candidate>& candidates) {
    for (Candidate& candidate : candidates) {
      double sum = 0.0;
      for (const VectorXd& run : candidate.log_densities) {
        candidate.score.samples += (!run.array().isNaN()).count();
        sum += run.array().isNaN().select(0.0, run).sum();
      }
      candidate.score.log_score = sum / static_cast<double>(candidate.score.samples);
    }
    const Candidate& best =
        *std::max_element(candidates.begin(), candidates.end(),
                          [](const Candidate& a, const Candidate& b) { return a.score.log_score < b.score.log_score; });
    if (best.score.samples == 0)
      throw DataError("the number of lags cannot be found by cross-validation: the runs are too short to predict any");
    for (Candidate& candidate : candidates) {
      const PairedGain gain = paired_gain("", best.log_densities, candidate.log_densities);
      candidate.score.loss = gain.gain;
      candidate.score.loss_standard_error = gain.standard_error;
    }
  }
};

}  // namespace

LagCounts find_lag_counts(const Recording& recording, const LagCountInputs& inputs, const Listener& listener) {
  return LagSearch(recording, inputs, listener).run();
}

ChainOptions with_lag_counts(ChainOptions options, const LagCounts& found) {
  options.window.state_lags = found.state_lags;
  options.window.input_lags = found.input_lags;
  return options;
}

}  // namespace modebank
