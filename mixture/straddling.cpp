#include "mixture/straddling.hpp"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <map>

namespace modebank {
namespace {

using Eigen::Index;
constexpr double significance = 0.99;

/// Windows between a window's start and that of its nearest neighbour without a shared transition.
Index neighbour_offset(const WindowFits& fits) { return (fits.length + fits.step - 1) / fits.step; }

bool same_run(const WindowFits& fits, Index a, Index b) {
  return fits.windows[static_cast<std::size_t>(a)].run == fits.windows[static_cast<std::size_t>(b)].run;
}

/// Labelled windows of one run in a row with the same label.
struct Episode {
  int label = -1;
  Index first = 0, last = 0;  ///< start samples of its first and last window
  Index span() const { return last - first; }
};

std::vector<Episode> joined(const std::vector<Episode>& episodes) {
  std::vector<Episode> result;
  for (const Episode& episode : episodes)
    if (!result.empty() && result.back().label == episode.label)
      result.back().last = episode.last;
    else
      result.push_back(episode);
  return result;
}

/// Rows of less than half a window between two rows of one label take that label, the shortest first.
std::vector<Episode> without_flicker(std::vector<Episode> episodes, Index length) {
  while (true) {
    std::size_t shortest = 0;
    for (std::size_t i = 1; i + 1 < episodes.size(); ++i)
      if (episodes[i - 1].label == episodes[i + 1].label && 2 * episodes[i].span() < length &&
          (shortest == 0 || episodes[i].span() < episodes[shortest].span()))
        shortest = i;
    if (shortest == 0) return episodes;
    episodes[shortest].label = episodes[shortest - 1].label;
    episodes = joined(episodes);
  }
}

struct Interval {
  double first, last;  ///< start samples
};

/// Where the windows of one run are in transit between settled rows, or between one and the run's ends.
std::vector<Interval> transits(const std::vector<Episode>& episodes, Index length) {
  constexpr double everything = 1e300;
  const double margin = 0.75 * static_cast<double>(length);
  std::vector<Interval> result;
  const Episode* before = nullptr;
  for (const Episode& episode : episodes) {
    if (episode.span() < length) continue;
    const auto first = static_cast<double>(episode.first);
    if (before) {
      const auto last = static_cast<double>(before->last);
      const double half = std::max(0.5 * (first - last), margin);
      result.push_back({0.5 * (first + last) - half, 0.5 * (first + last) + half});
    } else if (&episode != &episodes.front()) {
      result.push_back({-everything, first + margin});
    }
    before = &episode;
  }
  if (before && before != &episodes.back()) result.push_back({static_cast<double>(before->last) - margin, everything});
  return result;
}

/// The labelled windows of every run, by run.
std::map<Index, std::vector<Index>> labelled_windows(const WindowFits& fits, const Eigen::VectorXi& labels) {
  std::map<Index, std::vector<Index>> result;
  for (Index i = 0; i < labels.size(); ++i)
    if (labels(i) >= 0) result[fits.windows[static_cast<std::size_t>(i)].run].push_back(i);
  return result;
}

}  // namespace

std::vector<bool> windows_at_switches(const WindowFits& fits, const Eigen::VectorXi& labels) {
  std::vector<bool> flags(static_cast<std::size_t>(fits.count()), false);
  const auto start = [&](Index window) { return fits.windows[static_cast<std::size_t>(window)].start; };
  Index flagged = 0;
  for (const auto& [run, windows] : labelled_windows(fits, labels)) {
    std::vector<Episode> episodes;
    for (const Index window : windows) episodes.push_back({labels(window), start(window), start(window)});
    const std::vector<Interval> intervals = transits(without_flicker(joined(episodes), fits.length), fits.length);
    for (const Index window : windows)
      for (const auto& [first, last] : intervals) {
        const auto position = static_cast<double>(start(window));
        if (flags[static_cast<std::size_t>(window)] || !(position > first && position < last)) continue;
        flags[static_cast<std::size_t>(window)] = true;
        ++flagged;
      }
  }
  if (2 * flagged > (labels.array() >= 0).count()) std::fill(flags.begin(), flags.end(), false);
  return flags;
}

std::vector<bool> straddling_windows(const WindowFits& fits) {
  std::vector<bool> straddling(static_cast<std::size_t>(fits.count()), false);
  const auto unknowns = static_cast<double>(fits.parameter_count()) / static_cast<double>(fits.structure.states);
  const double freedom = static_cast<double>(fits.length) - unknowns;  // per state
  if (freedom <= 0.0) return straddling;
  const double threshold = boost::math::quantile(boost::math::fisher_f(freedom, freedom), significance);
  const Index offset = neighbour_offset(fits);
  for (Index i = offset; i + offset < fits.count(); ++i) {
    if (!same_run(fits, i - offset, i) || !same_run(fits, i, i + offset)) continue;
    const Eigen::ArrayXd calm =
        fits.noise_variance.col(i - offset).cwiseMax(fits.noise_variance.col(i + offset)).array();
    straddling[static_cast<std::size_t>(i)] = (fits.noise_variance.col(i).array() > threshold * calm).any();
  }
  return straddling;
}

}  // namespace modebank
