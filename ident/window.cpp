#include "ident/window.hpp"

#include <stdexcept>
#include <string>

namespace modebank {

std::vector<Window> make_windows(const Recording& recording, Index length, Index step, Index first) {
  if (length < 1) throw std::invalid_argument("window length " + std::to_string(length) + " is below 1");
  if (step < 1) throw std::invalid_argument("window step " + std::to_string(step) + " is below 1");
  std::vector<Window> windows;
  for (std::size_t r = 0; r < recording.runs.size(); ++r) {
    const Trajectory& run = recording.runs[r];
    if (run.role != Role::train) continue;
    for (Index start = first; start + length <= run.transitions(); start += step)
      windows.push_back({static_cast<Index>(r), start});
  }
  return windows;
}

}  // namespace modebank
