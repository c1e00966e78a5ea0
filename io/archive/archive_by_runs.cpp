#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "io/archive/bank/open_archive.hpp"
#include "io/archive/layout.hpp"
#include "io/hdf5/group_reader.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Values = GroupReader::Values;
using Fields = FilterEvaluation::Fields;

/// What filters said of the runs of an open archive that has been judged.
class RunsInFile {
 public:
  RunsInFile(hdf5::Handle file, std::string path, const Archive& archive)
      : file_(std::move(file)), path_(std::move(path)), states_(Units(*archive.recording).states()) {
    for (const Trajectory& run : archive.recording->runs) runs_.emplace_back(run.run, run.samples());
    for (const FilterEvaluation& evaluation : archive.evaluations) {
      const std::string place = "/evaluation/" + evaluation.filter;
      filters_.emplace(evaluation.filter, Filter{{hdf5::open_group(file_.id(), place), nullptr, place},
                                                 sizes_of_filter(archive, evaluation.filter)});
    }
  }
  ~RunsInFile() {
    const hdf5::Quiet quiet;
    filters_.clear();
    file_.reset();
  }
  RunsInFile(const RunsInFile&) = delete;
  RunsInFile& operator=(const RunsInFile&) = delete;

  void read(const std::string& filter, std::size_t run, const Fields& fields, RunEvaluation& said, FreeRun& free_run) {
    const hdf5::Quiet quiet;
    Filter& of = filters_.at(filter);
    const GroupReader::ValuesOf use = [&](const std::string& place) {
      return fields.contains(place.substr(place.rfind('/') + 1)) ? Values::kept : Values::unread;
    };
    of.reader.read_fields(use);
    const auto& [name, samples] = runs_.at(run);
    try {
      layout::exchange_filter_run(of.reader, name, samples, of.sizes, said, free_run, states_);
    } catch (const DataError& error) {
      throw DataError(path_ + ": " + error.what());
    }
  }

 private:
  struct Filter {
    GroupReader reader;  ///< stays, for it lists its runs once
    Sizes sizes;
  };

  hdf5::Handle file_;
  std::string path_;
  Unit states_;
  std::vector<std::pair<std::string, Index>> runs_;
  std::map<std::string, Filter> filters_;
};

/// /evaluation/FILTER/RUN/ARRAY.
bool is_of_run(const std::string& place) {
  constexpr auto depth = 4;
  return place.starts_with("/evaluation/") && std::count(place.begin(), place.end(), '/') == depth;
}

/// What neither a page nor a summary says of single windows.
bool is_untold_of_windows(const std::string& place) {
  static const std::set<std::string> untold{
      "/windows/condition", "/windows/information", "/windows/inlier_fraction",
      "/windows/r_squared", "/windows/aic",         "/windows/weighed_information"};
  return untold.contains(place);
}

bool are_many(const std::vector<Trajectory>& runs, Index most) {
  Index samples = 0;
  for (const Trajectory& run : runs) samples += run.samples();
  return samples > most;
}

}  // namespace

Archive read_archive_by_runs(const std::filesystem::path& path, Index most_in_memory) {
  const hdf5::Quiet quiet;
  hdf5::Handle file = open_archive(path, HashCheck::before);
  try {
    Archive archive;
    std::optional<bool> stay;  // the data are read by when evaluations are
    const GroupReader::ValuesOf use = [&](const std::string& place) {
      if (!is_of_run(place) && !is_untold_of_windows(place)) return Values::kept;
      if (!stay) stay = archive.recording && are_many(archive.recording->runs, most_in_memory);
      return *stay ? Values::judged : Values::kept;
    };
    GroupReader root(open_root(file), nullptr);
    root.read_fields(use);
    layout::exchange_archive(root, archive);
    root.check_links(links_of(archive));
    if (!stay.value_or(false)) return archive;
    const auto runs = std::make_shared<RunsInFile>(std::move(file), path.string(), archive);
    for (FilterEvaluation& evaluation : archive.evaluations)
      evaluation.in_file = [runs, filter = evaluation.filter](std::size_t run, const Fields& fields,
                                                              RunEvaluation& said, FreeRun& free_run) {
        runs->read(filter, run, fields, said, free_run);
      };
    return archive;
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  }
}

void judge_archive(const std::filesystem::path& path) { read_archive_by_runs(path, 0); }

void FilterEvaluation::with_run(std::size_t run, const Fields& fields,
                                const std::function<void(const RunEvaluation&)>& body) const {
  if (!in_file) return body(runs.at(run));
  RunEvaluation said;
  FreeRun unused;
  in_file(run, fields, said, unused);
  body(said);
}

void FilterEvaluation::with_free_run(std::size_t run, const std::function<void(const FreeRun&)>& body) const {
  if (!in_file) return body(free_runs.at(run));
  RunEvaluation unused;
  FreeRun free_run;
  in_file(run, {"free_run_mean", "free_run_sd", "free_run_lower", "free_run_upper"}, unused, free_run);
  body(free_run);
}

}  // namespace modebank
