#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace modebank {

/// Number of samples from each input to its first effect; 0: u[k+1] acts on x[k+1]. A single number is that of all
/// inputs.
class InputDelays {
 public:
  InputDelays(std::ptrdiff_t of_all = 1) : latest_(of_all) {}  ///< not explicit: a number is the delay of all inputs
  /// One number, or one per input.
  explicit InputDelays(const std::vector<std::ptrdiff_t>& listed) {
    if (!listed.empty()) latest_ = *std::max_element(listed.begin(), listed.end());
    if (listed.size() > 1) each_ = listed;
  }
  /// That of an input.
  std::ptrdiff_t operator[](std::ptrdiff_t input) const {
    return each_.empty() ? latest_ : each_[static_cast<std::size_t>(input)];
  }
  /// The least.
  std::ptrdiff_t earliest() const { return each_.empty() ? latest_ : *std::min_element(each_.begin(), each_.end()); }
  std::ptrdiff_t latest() const { return latest_; }                                                ///< the largest
  bool fits(std::ptrdiff_t inputs) const { return each_.empty() || std::ssize(each_) == inputs; }  ///< can be theirs
  /// One number per input.
  std::vector<std::ptrdiff_t> by_input(std::ptrdiff_t inputs) const {
    return each_.empty() ? std::vector<std::ptrdiff_t>(static_cast<std::size_t>(inputs), latest_) : each_;
  }
  /// One number if all inputs have the same; otherwise one per input.
  std::vector<std::ptrdiff_t> listed() const { return earliest() == latest_ ? std::vector{latest_} : each_; }
  /// These delays if `delay` is the latest of them; otherwise `delay` for all inputs.
  InputDelays with_latest(std::ptrdiff_t delay) const { return delay == latest_ ? *this : InputDelays(delay); }
  /// Whether each input has the same delay in both.
  friend bool operator==(const InputDelays& a, const InputDelays& b) {
    if (!a.each_.empty() && !b.each_.empty()) return a.each_ == b.each_;
    return a.latest_ == b.latest_ && a.earliest() == b.earliest();
  }

 private:
  std::ptrdiff_t latest_ = 1;
  std::vector<std::ptrdiff_t> each_ = {};  ///< empty: all inputs have the latest
};

}  // namespace modebank
