#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "filter/judge/combination.hpp"
#include "filter/learn/chain/inputs.hpp"
#include "filter/learn/refine/refine.hpp"
#include "ident/model/motion_model.hpp"
#include "mixture/select.hpp"

namespace modebank {

// The results of each stage of learning. A result is absent if its stage did not run.

struct StructurePart {
  std::optional<FoundStructure> structure;  ///< absent without a search
};

struct WindowsPart {
  std::optional<WindowFits> windows;
};

struct MixturePart {
  std::optional<MixtureResult> mixture;
};

struct CompetitorsPart {
  std::optional<Bank> baseline;        ///< one Kalman filter
  std::optional<Bank> noise_only;      ///< one motion; only its noise switches
  std::optional<Bank> nonlinear = {};  ///< one nonlinear motion; empty if no term gains on the training runs
};

struct BankPart {
  std::optional<Bank> bank;
  std::optional<Bank> one_motion;  ///< learned like the bank, with one theta
  std::optional<Bank> drifting;    ///< one linear motion whose coefficients drift, with the noise levels of one_motion
  std::optional<Bank> unrefined;   ///< the bank before expectation-maximisation
  MeasuredFit measured_fit = MeasuredFit::none;
  Index learned_transitions = 0;  ///< number of transitions that refined the bank; 0 means all training transitions
  std::vector<LeftOutRow> left_out = {};  ///< present if filters were learned without some of the training runs
};

/// All results of learning from runs.
struct Learning : StructurePart, WindowsPart, MixturePart, CompetitorsPart, BankPart {
  bool terms_asked = false;  ///< whether terms of `nonlinear` were searched, even if none gained

  /// The bank of this filter, if it exists. For the combination, its combined_frame.
  std::optional<Bank> bank_of(const std::string& filter) const;
};

/// A learned filter with the options to run it.
struct LearnedFilter {
  std::string name;
  Bank bank;
  FilterOptions options;
};

/// The bank and those competitors that exist. `options`: of the bank's filter.
std::vector<LearnedFilter> learned_filters(const Learning& learned, const FilterOptions& options);

/// Messages of a chain. detail: an intermediate trial; warning: a possible problem.
enum class Level { detail, progress, warning };
using Tell = std::function<void(Level, const std::string&)>;

/// Wall time since construction, for messages.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// "200,000 of 2,500,000".
std::string of_all(Index part, Index all);

/// "from 200,000 of 2,500,000 training transitions".
std::string learned_words(Index learned, Index all);

struct LearningHooks {
  /// Called for each stage in order: calls `compute`, or restores what an earlier call with equal inputs computed.
  std::function<void(Stage, const LearningInputs& inputs, const std::function<void()>& compute)> provide =
      [](Stage, const LearningInputs&, const std::function<void()>& compute) { compute(); };
  Tell tell = [](Level, const std::string&) {};
  std::function<void(const Refinement& bank)> refined = [](const Refinement&) {};  ///< called with each refined bank
  const MotionModel* motion = nullptr;  ///< the caller's own motion model; null: that of window.model, if any
};

/// Runs the stages in their only order, up to `last` (at most bank). `learned` holds the results of earlier calls and
/// receives the new ones. Throws ConfigurationError for options that do not fit the data, DataError for unusable data.
void learn_all(const Recording& recording, const LearningOptions& options, Stage last, const LearningHooks& hooks,
               Learning& learned);

}  // namespace modebank
