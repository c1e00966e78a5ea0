#include "mixture/merge_components.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "mixture/reduction.hpp"

namespace modebank {

MixtureResult merge_components(MixtureResult result, Eigen::Index most) {
  if (most < 1) throw std::invalid_argument("a mixture cannot be merged into " + std::to_string(most) + " components");
  Reduction reduction(std::move(result.mixture));
  while (reduction.components() > most) {
    const auto [into, absorbed] = reduction.merge_closest();
    result.responsibilities = std::move(result.responsibilities).merged(into, absorbed);
    for (int& label : result.labels)
      if (label == absorbed)
        label = static_cast<int>(into);
      else if (label > absorbed)
        --label;
  }
  result.mixture = reduction.mixture();
  return result;
}

}  // namespace modebank
