#include <exception>
#include <map>

#include "io/archive/archive.hpp"
#include "io/archive/archive_file.hpp"
#include "io/archive/groups/group_writer.hpp"
#include "io/archive/layout.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/run_names.hpp"
#include "io/files/sha256.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Number of values in all evaluations. These are the largest part of an archive of long recordings.
Index evaluated_numbers(const Archive& archive) {
  constexpr Index numbers_beside_covariances = 64;  // per sample
  if (!archive.recording) return 0;
  Index samples = 0, per_sample = 0;
  for (const Trajectory& run : archive.recording->runs) samples += run.samples();
  for (const FilterEvaluation& evaluation : archive.evaluations)
    if (!evaluation.runs.empty() && !evaluation.streamed)
      per_sample += numbers_beside_covariances + evaluation.runs.front().covariance.rows();
  return samples * per_sample;
}

/// Whether the archive is made on disk rather than in memory.
bool is_large(const Archive& archive) {
  constexpr Index most_in_memory = Index{2} << 20;  // doubles
  constexpr Index numbers_per_parameter = 8;        // values per parameter: estimate, error and description of the fit
  if (evaluated_numbers(archive) > most_in_memory / 2) return true;
  if (archive.windows &&
      numbers_per_parameter * archive.windows->parameters.size() + archive.windows->covariance.size() > most_in_memory)
    return true;
  if (!archive.mixture) return false;
  const WindowResponsibilities& responsibilities = archive.mixture->responsibilities;
  return responsibilities.windows() * responsibilities.components() > most_in_memory;
}

/// The unfinished file of an archive. The destructor closes the file.
class FileInTheMaking {
 public:
  explicit FileInTheMaking(const std::filesystem::path& path) {
    const hdf5::Quiet quiet;
    file_ = create_archive_file(path);
  }
  ~FileInTheMaking() {
    const hdf5::Quiet quiet;
    file_.reset();
  }
  FileInTheMaking(const FileInTheMaking&) = delete;
  FileInTheMaking& operator=(const FileInTheMaking&) = delete;

  const hdf5::Handle& file() const { return file_; }
  void complete() const {
    const hdf5::Quiet quiet;
    hdf5::check(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), "complete the archive");
  }

 private:
  hdf5::Handle file_;
};

void write_in_file(const std::filesystem::path& path, const std::function<void(const hdf5::Handle&)>& fill) {
  replace_file(path, [&](const std::filesystem::path& temporary) {
    {
      const FileInTheMaking making(temporary);
      fill(making.file());
      making.complete();
    }
    stamp_hash(temporary);
  });
}

/// Writes evaluations one after another.
class EvaluationFile {
 public:
  EvaluationFile(const hdf5::Handle& file, const Recording& recording)
      : file_(file), states_(Units(recording).states()), rows_(rows_of(recording.runs)) {}
  ~EvaluationFile() {
    const hdf5::Quiet quiet;
    filters_.clear();
  }
  EvaluationFile(const EvaluationFile&) = delete;
  EvaluationFile& operator=(const EvaluationFile&) = delete;

  void take(const std::string& filter, std::size_t run, const RunEvaluation& said, const FreeRun* free_run) {
    const hdf5::Quiet quiet;
    if (filter != latest_ && !latest_.empty()) filters_.at(latest_).flush();
    latest_ = filter;
    SampleWriter& samples = samples_of(filter);
    samples.begin_run(rows_.at(run));
    layout::exchange_filter_run(samples, said, free_run ? *free_run : FreeRun(), states_);
  }
  void finish() {
    for (auto& [name, samples] : filters_) samples.finish();
  }

 private:
  SampleWriter& samples_of(const std::string& filter) {
    if (const auto found = filters_.find(filter); found != filters_.end()) return found->second;
    const hsize_t total = rows_.empty() ? 0 : rows_.back().end();
    GroupWriter root(open_root(file_));
    root.group("evaluation", {}, [&](GroupWriter& evaluation) {
      evaluation.group(filter, {}, [&](GroupWriter& group) { filters_.try_emplace(filter, group, total); });
    });
    return filters_.at(filter);
  }

  const hdf5::Handle& file_;
  Unit states_;
  std::vector<hdf5::Rows> rows_;
  std::map<std::string, SampleWriter> filters_;
  std::string latest_;
};

/// Marks an exception of the caller's function. Such an exception is not a write error.
struct NotMade {};

}  // namespace

void write_large_archive(const std::filesystem::path& path, const Archive& archive) {
  if (archive.recording) check_run_names(run_names(archive.recording->runs));
  write_in_file(path, [&](const hdf5::Handle& file) {
    const hdf5::Quiet quiet;
    GroupWriter root(open_root(file));
    layout::exchange_archive(root, archive);
  });
}

void write_archive(const std::filesystem::path& path, const Archive& archive) {
  if (is_large(archive)) return write_large_archive(path, archive);
  if (archive.recording) check_run_names(run_names(archive.recording->runs));
  const hdf5::Quiet quiet;
  const ArchiveImage image;
  {
    GroupWriter root(open_root(image.file()));
    layout::exchange_archive(root, archive);
  }
  const std::string_view content = image.content();
  const UserBlock block = make_user_block(sha256_hex(content));
  replace_file(path, {std::string_view(block.data(), block.size()), content});
}

WindowFits write_archive(const std::filesystem::path& path, const Archive& archive, Index count,
                         const std::function<WindowFits(const WindowSink&)>& produce) {
  const Recording& recording = archive.recording.value();
  check_run_names(run_names(recording.runs));
  const Units units(recording);
  WindowFits common;
  write_in_file(path, [&](const hdf5::Handle& file) {
    const hdf5::Quiet quiet;
    GroupWriter root(open_root(file));
    layout::exchange_archive(root, archive);
    root.group("windows", {}, [&](GroupWriter& member) {
      common = produce([&](const WindowFits& fits, Index first) {
        member.windows_from(static_cast<hsize_t>(first), static_cast<hsize_t>(fits.count()),
                            static_cast<hsize_t>(count), run_names(recording.runs));
        layout::exchange_windows(member, fits, recording, units);
      });
    });
  });
  return common;
}

void write_archive(const std::filesystem::path& path, const Recording& recording,
                   const std::function<const Archive&(const EvaluationSink&)>& make) {
  check_run_names(run_names(recording.runs));
  std::exception_ptr failure;
  try {
    write_in_file(path, [&](const hdf5::Handle& file) {
      EvaluationFile evaluations(file, recording);
      const EvaluationSink sink = [&](const std::string& filter, std::size_t run, const RunEvaluation& said,
                                      const FreeRun* free_run) { evaluations.take(filter, run, said, free_run); };
      const Archive* archive = nullptr;
      try {
        archive = &make(sink);
      } catch (...) {
        failure = std::current_exception();
        throw NotMade{};
      }
      const hdf5::Quiet quiet;
      evaluations.finish();
      GroupWriter root(open_root(file));
      layout::exchange_archive(root, *archive);
    });
  } catch (const NotMade&) {
    std::rethrow_exception(failure);
  }
}

}  // namespace modebank
