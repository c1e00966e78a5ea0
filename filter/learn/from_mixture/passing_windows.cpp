#include "filter/learn/from_mixture/passing_windows.hpp"

#include <cstddef>
#include <vector>

#include "mixture/window_over_switch.hpp"

namespace modebank {
namespace {

/// Successive clustered windows with the same label in one run. They are [first, end) of `windows`, in order of start.
struct SameLabel {
  std::size_t first = 0, end = 0;
};

class LabelStretches {
 public:
  LabelStretches(const WindowFits& fits, const Eigen::VectorXi& labels) : fits_(fits), labels_(labels) {
    for (Index i = 0; i < fits.count(); ++i)
      if (labels(i) >= 0) windows_.push_back(i);
    for (std::size_t at = 0; at < windows_.size(); at = stretches_.back().end) {
      std::size_t end = at + 1;
      while (end < windows_.size() && same_run(at, end) && label(end) == label(at)) ++end;
      stretches_.push_back({at, end});
    }
  }

  const std::vector<Index>& windows() const { return windows_; }
  const std::vector<SameLabel>& stretches() const { return stretches_; }
  int label(std::size_t at) const { return labels_(windows_[at]); }

  /// Whether a stretch of windows with one label is too short. Look for the first window that shares no transition with
  /// the last window before the stretch. The stretch is too short if it ends before this window.
  bool passes(const SameLabel& stretch) const {
    if (stretch.first == 0 || stretch.end == windows_.size()) return false;
    const std::size_t before = stretch.first - 1;
    return same_run(before, stretch.first) && same_run(stretch.first, stretch.end) &&
           window(stretch.end).start - window(before).start < fits_.length + 2 * fits_.step;
  }

 private:
  const Window& window(std::size_t at) const { return fits_.windows[static_cast<std::size_t>(windows_[at])]; }
  bool same_run(std::size_t a, std::size_t b) const { return window(a).run == window(b).run; }

  const WindowFits& fits_;
  const Eigen::VectorXi& labels_;
  std::vector<Index> windows_;
  std::vector<SameLabel> stretches_;
};

}  // namespace

Eigen::VectorXd passing_shares(const WindowFits& fits, const MixtureResult& mixture) {
  const std::vector<bool> over_switch = windows_over_switch(fits);
  const LabelStretches runs(fits, mixture.labels);
  Eigen::VectorXd passing = Eigen::VectorXd::Zero(mixture.mixture.components()), all = passing;
  for (const SameLabel& stretch : runs.stretches()) {
    const bool passes = runs.passes(stretch);
    for (std::size_t at = stretch.first; at < stretch.end; ++at) {
      all(runs.label(at)) += 1.0;
      if (passes || over_switch[static_cast<std::size_t>(runs.windows()[at])]) passing(runs.label(at)) += 1.0;
    }
  }
  return passing.cwiseQuotient(all.cwiseMax(1.0));
}

}  // namespace modebank
