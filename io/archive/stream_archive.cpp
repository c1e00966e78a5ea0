#include <exception>

#include "io/archive/archive_file.hpp"
#include "io/archive/layout.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/run_names.hpp"
#include "io/hdf5/group_writer.hpp"

namespace modebank {
namespace {

/// A file whose evaluations are written one after another, all else at the end.
class StreamedFile {
 public:
  StreamedFile(const std::filesystem::path& path, const Recording& recording)
      : recording_(recording), states_(Units(recording).states()) {
    const hdf5::Quiet quiet;
    file_ = create_archive_file(path);
  }
  ~StreamedFile() {
    const hdf5::Quiet quiet;
    file_.reset();
  }
  StreamedFile(const StreamedFile&) = delete;
  StreamedFile& operator=(const StreamedFile&) = delete;

  void take(const std::string& filter, std::size_t run, const RunEvaluation& said, const FreeRun* free_run) const {
    const hdf5::Quiet quiet;
    const FreeRun none;
    GroupWriter root(open_root(file_));
    root.go_on_with_groups();
    root.group("evaluation", {}, [&](GroupWriter& evaluations) {
      evaluations.go_on_with_groups();
      evaluations.group(filter, {}, [&](GroupWriter& runs) {
        const Trajectory& of = recording_.runs.at(run);
        layout::exchange_filter_run(runs, of.run, of.samples(), Sizes(), said, free_run ? *free_run : none, states_);
      });
    });
  }
  void complete(const Archive& archive) const {
    const hdf5::Quiet quiet;
    GroupWriter root(open_root(file_));
    root.go_on_with_groups();
    layout::exchange_archive(root, archive);
    hdf5::check(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), "complete the archive");
  }

 private:
  const Recording& recording_;
  Unit states_;
  hdf5::Handle file_;
};

/// Stands for what was thrown while the archive was made, which is no failure of writing.
struct NotMade {};

}  // namespace

void stream_archive(const std::filesystem::path& path, const Recording& recording,
                    const std::function<const Archive&(const EvaluationSink&)>& make) {
  check_run_names(run_names(recording.runs));
  std::exception_ptr failure;
  try {
    replace_file(path, [&](const std::filesystem::path& temporary) {
      {
        const StreamedFile file(temporary, recording);
        const Archive* archive = nullptr;
        try {
          archive = &make([&](const std::string& filter, std::size_t run, const RunEvaluation& said,
                              const FreeRun* free_run) { file.take(filter, run, said, free_run); });
        } catch (...) {
          failure = std::current_exception();
          throw NotMade{};
        }
        file.complete(*archive);
      }
      stamp_hash(temporary);
    });
  } catch (const NotMade&) {
    std::rethrow_exception(failure);
  }
}

}  // namespace modebank
