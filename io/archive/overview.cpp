#include <algorithm>
#include <functional>
#include <set>

#include "io/archive/bank/open_archive.hpp"
#include "io/archive/layout.hpp"
#include "io/hdf5/group_reader.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Below /evaluation and /residual_tests.
bool is_of_a_run(const std::string& place) {
  constexpr auto depth = 4;
  return std::count(place.begin(), place.end(), '/') == depth;
}

/// What of the filters' evaluations and of the residual tests an overview wants.
class Overview {
 public:
  Overview(const Archive& archive, Index runs) : archive_(archive), runs_(runs) {}

  bool wants_model(const std::string& model) const { return model == "global" || model == "bank"; }
  bool wants_run(const std::string& filter, const std::string& run) {
    if (shown_.empty()) list_shown();
    return filter == "bank" && shown_.contains(run);
  }
  bool wants(const std::string& place) {
    const std::string tests = "/residual_tests/", evaluations = "/evaluation/";
    if (!is_of_a_run(place)) return true;
    if (place.starts_with(tests)) return wants_model(part(place, 2));
    return !place.starts_with(evaluations) || wants_run(part(place, 2), part(place, 3));
  }

 private:
  const Archive& archive_;  ///< whose data are read by then
  Index runs_;
  std::set<std::string> shown_;

  /// The n-th between slashes.
  static std::string part(const std::string& place, int n) {
    std::size_t begin = 0;
    while (n-- > 0) begin = place.find('/', begin) + 1;
    return place.substr(begin, place.find('/', begin) - begin);
  }

  void list_shown() {
    if (!archive_.recording) return;
    const std::vector<Trajectory>& runs = archive_.recording->runs;
    const auto tests = [](const Trajectory& run) { return run.role == Role::test; };
    const Role judged = std::any_of(runs.begin(), runs.end(), tests) ? Role::test : Role::train;
    for (const Trajectory& run : runs)
      if (run.role == judged && std::ssize(shown_) < runs_) shown_.insert(run.run);
  }
};

/// What was judged alone leaves nothing.
void keep_wanted(Archive& archive, Overview& overview) {
  for (ResidualTestSet& set : archive.residual_tests)
    if (!overview.wants_model(set.model)) set.runs.clear();
  for (FilterEvaluation& evaluation : archive.evaluations) {
    if (evaluation.filter != "bank") {
      evaluation.runs.clear();
      evaluation.free_runs.clear();
      continue;
    }
    for (std::size_t i = 0; i < evaluation.runs.size(); ++i)
      if (!overview.wants_run(evaluation.filter, archive.recording->runs[i].run)) {
        evaluation.runs[i] = {};
        if (!evaluation.free_runs.empty()) evaluation.free_runs[i] = {};
      }
  }
}

}  // namespace

Archive read_overview(const std::filesystem::path& path, Index runs) {
  const hdf5::Quiet quiet;
  const hdf5::Handle file = open_archive(path, HashCheck::before);
  try {
    Archive archive;
    Overview overview(archive, runs);
    const GroupReader::ValuesOf use = [&](const std::string& place) {
      return overview.wants(place) ? GroupReader::Values::kept : GroupReader::Values::judged;
    };
    GroupReader root(open_root(file), nullptr);
    root.read_fields(use);
    layout::exchange_archive(root, archive);
    root.check_links(links_of(archive));
    keep_wanted(archive, overview);
    return archive;
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  }
}

}  // namespace modebank
