#include <map>
#include <memory>
#include <utility>

#include "io/archive/archive.hpp"
#include "io/archive/groups/group_reader.hpp"
#include "io/archive/layout.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Fields = FilterEvaluation::Fields;

/// Evaluations that are not loaded but stay in the archive's file.
class EvaluationsInFile {
 public:
  EvaluationsInFile(OpenArchive file, const Archive& archive)
      : file_(std::move(file)), states_(Units(*archive.recording).states()), rows_(rows_of(archive.recording->runs)) {
    GroupReader root(file_.root(), nullptr);
    root.group("evaluation", {}, [&](GroupReader& evaluations) {
      for (const FilterEvaluation& evaluation : archive.evaluations)
        evaluations.group(evaluation.filter, sizes_of_filter(archive, evaluation.filter), [&](GroupReader& group) {
          filters_.try_emplace(evaluation.filter, std::move(group), rows_.empty() ? 0 : rows_.back().end());
        });
    });
  }
  ~EvaluationsInFile() {
    const hdf5::Quiet quiet;
    filters_.clear();
  }
  EvaluationsInFile(const EvaluationsInFile&) = delete;
  EvaluationsInFile& operator=(const EvaluationsInFile&) = delete;

  void read(const std::string& filter, std::size_t run, const Fields& fields, RunEvaluation& said, FreeRun& free_run) {
    const hdf5::Quiet quiet;
    SampleReader& samples = filters_.at(filter).samples;
    samples.begin_run(rows_.at(run), &fields);
    try {
      layout::exchange_filter_run(samples, said, free_run, states_);
    } catch (const DataError& error) {
      throw DataError(file_.path().string() + ": " + error.what());
    }
  }

 private:
  struct Filter {
    GroupReader group;
    SampleReader samples;
    Filter(GroupReader&& of_filter, hsize_t total) : group(std::move(of_filter)), samples(group, total) {}
  };

  OpenArchive file_;
  Unit states_;
  std::vector<hdf5::Rows> rows_;
  std::map<std::string, Filter> filters_;
};

/// The arrays of windows that are shown neither on a page nor in a summary.
LeftOut left_out_by(Evaluations evaluations) {
  if (evaluations == Evaluations::in_memory) return {};
  return {{"/windows/condition", "/windows/information", "/windows/inlier_fraction", "/windows/weighed_information"},
          true};
}

Archive read_stages(const OpenArchive& file, const LeftOut& left_out, std::vector<std::string>* problems) {
  Archive archive;
  GroupReader root(file.root(), problems);
  root.leave_out(left_out);
  layout::exchange_archive(root, archive);
  return archive;
}

}  // namespace

Archive read_archive(const OpenArchive& file, Evaluations evaluations) {
  const hdf5::Quiet quiet;
  try {
    Archive archive = read_stages(file, left_out_by(evaluations), nullptr);
    if (evaluations == Evaluations::in_memory || archive.evaluations.empty()) return archive;
    const auto runs = std::make_shared<EvaluationsInFile>(file, archive);
    for (FilterEvaluation& evaluation : archive.evaluations)
      evaluation.in_file = [runs, filter = evaluation.filter](std::size_t run, const Fields& fields,
                                                              RunEvaluation& said, FreeRun& free_run) {
        runs->read(filter, run, fields, said, free_run);
      };
    return archive;
  } catch (const DataError& error) {
    throw DataError(file.path().string() + ": " + error.what());
  }
}

std::vector<std::string> problems_of(const OpenArchive& file) {
  const hdf5::Quiet quiet;
  std::vector<std::string> problems;
  try {
    read_stages(file, {}, &problems);
  } catch (const DataError& error) {
    problems.emplace_back(error.what());
  }
  return problems;
}

Verification verify_archive(const std::filesystem::path& path) try {
  return {problems_of(path)};
} catch (const DataError& error) {
  return {{error.what()}};
}

}  // namespace modebank
