#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/report/page/bucket_extremes.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/text/judged_runs.hpp"
#include "app/text/mode_names.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

constexpr Index most_runs = 6, most_buckets = 1200;  // enough buckets for a picture as wide as a screen
constexpr double steps = 2000.0;                     // number of different heights; a step is finer than a pixel of the
                                                     // picture

/// The most frequent of `count` values from index `first` on. The value -1 also counts.
int most_frequent(const Eigen::VectorXi& values, Index first, Index count, std::size_t names) {
  std::vector<Index> counts(names + 1, 0);
  for (Index i = first; i < std::min(first + count, values.size()); ++i)
    ++counts[static_cast<std::size_t>(1L + values(i))];
  return static_cast<int>(std::max_element(counts.begin(), counts.end()) - counts.begin()) - 1;
}

json labels_over(const Eigen::VectorXi& values, Index bucket, std::size_t names) {
  json list = json::array();
  for (Index first = 0; first < values.size(); first += bucket)
    list.push_back(most_frequent(values, first, bucket, names));
  return list;
}

/// The most probable mode in each bucket; -1 if unknown.
json modes_over(const Eigen::MatrixXd& probability, Index bucket) {
  Eigen::MatrixXd means(probability.rows(), (probability.cols() + bucket - 1) / bucket);
  for (Index k = 0; k < means.rows(); ++k) means.row(k) = bucket_means(probability.row(k).transpose(), bucket);
  json list = json::array();
  for (Index i = 0; i < means.cols(); ++i) {
    Index best = -1;
    if (means.rows() > 0 && means.col(i).allFinite()) means.col(i).maxCoeff(&best);
    list.push_back(best);
  }
  return list;
}

struct Range {
  double low = 0.0, high = 0.0;
};

Range range_of(const Recording& recording, const std::vector<std::size_t>& runs) {
  Range range{INFINITY, -INFINITY};
  for (const std::size_t i : runs)
    for (const double value : recording.runs[i].state.row(0))
      if (std::isfinite(value)) range = {std::min(range.low, value), std::max(range.high, value)};
  if (range.low > range.high) return {-1.0, 1.0};
  if (range.low == range.high) return {range.low - 1.0, range.high + 1.0};
  return range;
}

json heights(const Eigen::VectorXd& values, const Range& range) {
  json list = json::array();
  for (const double value : values)
    list.push_back(std::isfinite(value) ? json(std::lround(steps * (value - range.low) / (range.high - range.low)))
                                        : json());
  return list;
}

/// The judged runs, but not more than a picture can show.
std::vector<std::size_t> pictured_runs(const Recording& recording, Role role) {
  std::vector<std::size_t> runs;
  for (std::size_t i = 0; i < recording.runs.size() && std::ssize(runs) < most_runs; ++i)
    if (recording.runs[i].role == role && recording.runs[i].samples() > 1) runs.push_back(i);
  return runs;
}

json run_of(const Archive& archive, std::size_t i, Index bucket, const Range& range) {
  const Trajectory& run = archive.recording->runs[i];
  const BucketExtremes extremes = bucket_extremes(run.state.row(0).transpose(), bucket);
  json entry = {{"name", run.run},
                {"seconds", run.time_s(run.samples() - 1) - run.time_s(0)},
                {"low", heights(extremes.low, range)}};
  if (bucket > 1) entry["high"] = heights(extremes.high, range);
  const FilterEvaluation* const bank = evaluation_of(archive, "bank");
  if (bank && i < bank->runs.size())
    bank->with_run(i, {"mode_probability"},
                   [&](const RunEvaluation& said) { entry["mode"] = modes_over(said.mode_probability, bucket); });
  if (archive.labels && i < archive.labels->of_runs.size() && archive.labels->of_runs[i].size() > 0)
    entry["label"] = labels_over(archive.labels->of_runs[i], bucket, archive.labels->names.size());
  return entry;
}

}  // namespace

nlohmann::json picture_of(const Archive& archive) {
  if (!archive.recording || archive.recording->states.empty()) return nullptr;
  const Recording& recording = *archive.recording;
  const Role role = judged_role(archive);
  const std::vector<std::size_t> shown = pictured_runs(recording, role);
  if (shown.empty()) return nullptr;
  Index samples = 0;
  for (const std::size_t i : shown) samples += recording.runs[i].samples();
  const Index bucket = std::max<Index>(1, (samples + most_buckets - 1) / most_buckets);
  const Range range = range_of(recording, shown);
  json runs = json::array(), names = json::array();
  for (const std::size_t i : shown) runs.push_back(run_of(archive, i, bucket, range));
  if (archive.labels)
    for (const std::string& name : archive.labels->names) names.push_back(one_line(name));
  const auto of_role = std::count_if(recording.runs.begin(), recording.runs.end(),
                                     [role](const Trajectory& run) { return run.role == role; });
  const Channel& state = recording.states.front();
  return {{"state", {{"name", state.name}, {"unit", state.unit}}},
          {"range", {range.low, range.high}},
          {"steps", steps},
          {"runs", runs},
          {"of_runs", of_role},
          {"labels", names},
          {"modes", archive.bank && evaluation_of(archive, "bank") ? archive.bank->mode_count() : 0}};
}

}  // namespace modebank::app::report
