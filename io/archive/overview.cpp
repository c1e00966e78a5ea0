#include <algorithm>
#include <functional>
#include <set>

#include "io/archive/bank/open_archive.hpp"
#include "io/archive/layout.hpp"
#include "io/hdf5/group_reader.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// The groups below /evaluation and /residual_tests that an overview wants.
class OverviewGroups {
 public:
  OverviewGroups(const Archive& archive, Index runs) : archive_(archive), runs_(runs) {}

  bool operator()(const std::string& path) {
    const std::string bank = "/evaluation/bank", tests = "/residual_tests/", evaluations = "/evaluation/";
    if (path == bank || path == evaluations + "evidence") return true;
    if (path.starts_with(tests)) return path.starts_with(tests + "global") || path.starts_with(tests + "bank");
    if (!path.starts_with(evaluations)) return true;
    if (!path.starts_with(bank + "/")) return false;
    if (shown_.empty()) list_shown(bank);
    return shown_.contains(path);
  }

 private:
  const Archive& archive_;  ///< whose data are read by then
  Index runs_;
  std::set<std::string> shown_;

  void list_shown(const std::string& bank) {
    if (!archive_.recording) return;
    const std::vector<Trajectory>& runs = archive_.recording->runs;
    const auto tests = [](const Trajectory& run) { return run.role == Role::test; };
    const Role judged = std::any_of(runs.begin(), runs.end(), tests) ? Role::test : Role::train;
    for (const Trajectory& run : runs)
      if (run.role == judged && std::ssize(shown_) < runs_) shown_.insert(bank + "/" + run.run);
  }
};

}  // namespace

Archive read_overview(const std::filesystem::path& path, Index runs) {
  const hdf5::Quiet quiet;
  const hdf5::Handle file = open_archive(path, HashCheck::before);
  try {
    Archive archive;
    const std::function<bool(const std::string&)> wanted = OverviewGroups(archive, runs);
    GroupReader root(open_root(file), nullptr);
    root.read_groups(wanted);
    layout::exchange_archive(root, archive);
    return archive;
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  }
}

}  // namespace modebank
