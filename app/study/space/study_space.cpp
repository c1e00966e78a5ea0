#include "app/study/space/study_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <cmath>
#include <set>

#include "app/config/option_text.hpp"
#include "ident/base/seed.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// Keys whose values change together: a single key, or the keys of a `together` line.
struct Axis {
  std::vector<std::size_t> members;  ///< indices of these keys in the list of varied keys
  std::size_t levels = 0;            ///< number of values; 0 for a range
};

/// All parts of the [study] section that define points.
struct Definition {
  std::vector<VariedKey> varied;
  std::vector<Axis> axes;
};

/// Index of a varied key; if the key is not varied, the number of varied keys.
std::size_t position_of(const std::vector<VariedKey>& varied, const std::string& key) {
  const auto found = std::find_if(varied.begin(), varied.end(), [&](const VariedKey& v) { return v.key == key; });
  return static_cast<std::size_t>(found - varied.begin());
}

std::vector<VariedKey> read_varied(const StudyConfig& study) {
  std::vector<VariedKey> varied;
  for (const std::string& line : study.vary) {
    varied.push_back(parse_vary(line));
    if (position_of(varied, varied.back().key) + 1 != varied.size())
      throw ConfigurationError(fmt::format("study.vary: {} is varied in two lines", varied.back().key));
    if (varied.back().is_range() && study.sample == 0)
      throw ConfigurationError(
          fmt::format("study.vary = {}: a range needs a number of values (lin N or log N), or study.sample", line));
  }
  return varied;
}

/// The group that each `together` line defines. Checks that the keys of these lines are varied.
std::vector<Axis> read_groups(const StudyConfig& study, const std::vector<VariedKey>& varied) {
  std::vector<Axis> groups;
  std::set<std::size_t> taken;
  for (const std::string& line : study.together) {
    Axis axis;
    for (const std::string& key : parse_together(line)) {
      const std::size_t member = position_of(varied, key);
      const auto refuse = [&](const std::string& why) {
        throw ConfigurationError(fmt::format("study.together = {}: {} {}", line, key, why));
      };
      if (member == varied.size()) refuse("is not varied");
      if (!taken.insert(member).second) refuse("is named twice");
      if (varied[member].is_range()) refuse("is a range; keys in study.together need lists of values");
      if (axis.levels != 0 && axis.levels != varied[member].values.size())
        refuse(fmt::format("has {} values, {} has {}", varied[member].values.size(), varied[axis.members[0]].key,
                           axis.levels));
      axis.levels = varied[member].values.size();
      axis.members.push_back(member);
    }
    groups.push_back(axis);
  }
  return groups;
}

/// Axes in the order of study.vary. The position of a group is that of its first key.
std::vector<Axis> make_axes(const std::vector<VariedKey>& varied, const std::vector<Axis>& groups) {
  std::vector<Axis> axes;
  for (std::size_t i = 0; i < varied.size(); ++i) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const Axis& axis) {
      return std::find(axis.members.begin(), axis.members.end(), i) != axis.members.end();
    });
    if (group == groups.end())
      axes.push_back({{i}, varied[i].values.size()});
    else if (*std::min_element(group->members.begin(), group->members.end()) == i)
      axes.push_back(*group);
  }
  return axes;
}

Definition read_definition(const StudyConfig& study) {
  Definition definition;
  definition.varied = read_varied(study);
  definition.axes = make_axes(definition.varied, read_groups(study, definition.varied));
  return definition;
}

/// Sets the texts of one axis in a point. The coordinate u along the axis is in [0, 1).
void place(const Definition& definition, const Axis& axis, double u, StudyPoint& point) {
  for (const std::size_t member : axis.members) {
    const VariedKey& varied = definition.varied[member];
    if (!varied.is_range()) {
      const auto level = static_cast<std::size_t>(u * static_cast<double>(axis.levels));
      point[member] = varied.values[std::min(level, axis.levels - 1)];
    } else {
      const double value = varied.logarithmic ? varied.low * std::pow(varied.high / varied.low, u)
                                              : varied.low + (varied.high - varied.low) * u;
      point[member] = format_value(value);
    }
  }
}

std::vector<StudyPoint> grid(const Definition& definition) {
  constexpr std::size_t most_points = 1'000'000;
  std::size_t count = 1;
  for (const Axis& axis : definition.axes) {
    count *= axis.levels;
    if (count > most_points)
      throw ConfigurationError(fmt::format(
          "study.vary: the grid has more than {} points; set study.sample = N to draw N points", most_points));
  }
  std::vector<StudyPoint> points(count, StudyPoint(definition.varied.size()));
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t rest = i;
    for (auto axis = definition.axes.rbegin(); axis != definition.axes.rend(); ++axis) {
      for (const std::size_t member : axis->members)
        points[i][member] = definition.varied[member].values[rest % axis->levels];
      rest /= axis->levels;
    }
  }
  return points;
}

/// Coordinates in [0, 1), one row per point. Each axis is divided into as many strata as there are points, and each
/// stratum contains one point.
std::vector<std::vector<double>> latin_hypercube(std::size_t count, std::size_t axes, std::uint64_t seed) {
  std::vector<std::vector<double>> coordinates(count, std::vector<double>(axes));
  boost::random::uniform_01<double> uniform;
  for (std::size_t a = 0; a < axes; ++a) {
    std::mt19937_64 generator = make_generator(seed, "study.sample", a);
    std::vector<std::size_t> strata(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = boost::random::uniform_int_distribution<std::size_t>(0, i)(generator);
      strata[i] = strata[j];
      strata[j] = i;
    }
    for (std::size_t i = 0; i < count; ++i)
      coordinates[i][a] = (static_cast<double>(strata[i]) + uniform(generator)) / static_cast<double>(count);
  }
  return coordinates;
}

std::vector<StudyPoint> samples(const Definition& definition, const Config& config) {
  const auto count = static_cast<std::size_t>(config.study.sample);
  const std::size_t axes = definition.axes.size();
  const auto coordinates = latin_hypercube(count, axes, config.job.seed);
  std::vector<StudyPoint> points(count, StudyPoint(definition.varied.size()));
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t a = 0; a < axes; ++a) place(definition, definition.axes[a], coordinates[i][a], points[i]);
  return points;
}

}  // namespace

StudySpace lay_out(const Config& config) {
  const Definition definition = read_definition(config.study);
  if (definition.varied.empty())
    throw ConfigurationError("study.vary is empty; name the keys to vary, for example vary = window.step = 1 | 5");
  StudySpace space;
  for (const VariedKey& varied : definition.varied) space.keys.push_back(varied.key);
  std::set<StudyPoint> seen;
  for (StudyPoint& point : config.study.sample > 0 ? samples(definition, config) : grid(definition)) {
    if (seen.insert(point).second)
      space.points.push_back(std::move(point));
    else
      ++space.repeated;
  }
  return space;
}

}  // namespace modebank::app
