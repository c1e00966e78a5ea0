#include "io/archive/archive.hpp"

#include "io/archive/archive_file.hpp"
#include "io/archive/bank/open_archive.hpp"
#include "io/archive/layout.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/run_names.hpp"
#include "io/files/sha256.hpp"
#include "io/hdf5/group_reader.hpp"
#include "io/hdf5/group_writer.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

/// Beyond this much an archive is made in the file system rather than in memory.
bool is_large(const Archive& archive) {
  constexpr Index most_in_memory = Index{32} << 20;  // doubles
  constexpr Index numbers_per_parameter = 8;  // of a window: value, error, covariances and what describes the fit
  constexpr std::size_t many_runs = 500;      // whose groups are appended to a file, not made by HDF5 in memory
  if (archive.recording && archive.recording->runs.size() > many_runs) return true;
  const Index parameters = archive.windows ? archive.windows->count() * archive.windows->parameter_count() : 0;
  if (parameters > most_in_memory / numbers_per_parameter) return true;
  if (!archive.mixture) return false;
  const WindowResponsibilities& responsibilities = archive.mixture->responsibilities;
  return responsibilities.windows() * responsibilities.components() > most_in_memory;
}

}  // namespace

void write_large_archive(const std::filesystem::path& path, const Archive& archive) {
  if (archive.recording) check_run_names(run_names(archive.recording->runs));
  const hdf5::Quiet quiet;
  replace_file(path, [&](const std::filesystem::path& temporary) {
    {
      const hdf5::Handle file = create_archive_file(temporary);
      GroupWriter root(open_root(file));
      layout::exchange_archive(root, archive);
      hdf5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "complete the archive");
    }
    stamp_hash(temporary);
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
  const hdf5::Quiet quiet;
  const Units units(recording);
  WindowFits common;
  replace_file(path, [&](const std::filesystem::path& temporary) {
    {
      const hdf5::Handle file = create_archive_file(temporary);
      GroupWriter root(open_root(file));
      layout::exchange_origin(root, archive);
      root.group("data", {}, [&](GroupWriter& member) {
        layout::exchange_recording(member, recording, archive.labels, archive.step_scatter);
      });
      layout::exchange_part(root, "lag", archive.lag, {},
                            [](GroupWriter& member, const LagReport& lag) { layout::exchange_lag(member, lag); });
      layout::exchange_part(
          root, "structure", archive.structure, {},
          [](GroupWriter& member, const FoundStructure& found) { layout::exchange_structure(member, found); });
      root.group("windows", {}, [&](GroupWriter& member) {
        common = produce([&](const WindowFits& fits, Index first) {
          member.windows_from(static_cast<hsize_t>(first), static_cast<hsize_t>(fits.count()),
                              static_cast<hsize_t>(count), run_names(recording.runs));
          layout::exchange_windows(member, fits, recording, units);
        });
      });
      hdf5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "complete the archive");
    }
    stamp_hash(temporary);
  });
  return common;
}

std::optional<Bank> Archive::bank_of(const std::string& filter) const {
  if (filter == "bank") return bank;
  if (filter == "baseline") return baseline;
  if (filter == "noise_only") return noise_only;
  if (filter == "one_motion") return one_motion;
  if (filter == "nonlinear") return nonlinear;
  if (filter == "drifting" && drifting) return fixed_bank(*drifting);
  if (filter == combined_name && bank) return combined_frame(*bank);
  return {};
}

namespace {

/// Without a list the first problem is thrown as DataError; with one all problems are listed, each with its place, and
/// what is returned is incomplete.
Archive read_stages(const hdf5::Handle& file, std::vector<std::string>* problems) {
  Archive archive;
  GroupReader root(open_root(file), problems);
  layout::exchange_archive(root, archive);
  root.check_links(links_of(archive));
  return archive;
}

}  // namespace

Archive read_archive(const std::filesystem::path& path) {
  const hdf5::Quiet quiet;
  const hdf5::Handle file = open_archive(path, HashCheck::before);
  try {
    return read_stages(file, nullptr);
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  }
}

Verification verify_archive(const std::filesystem::path& path) {
  require_readable(path);
  const hdf5::Quiet quiet;
  Verification verification{hash_problems(path)};
  try {
    std::vector<std::string> found;
    read_stages(open_archive(path, HashCheck::before), &found);
    verification.problems.insert(verification.problems.end(), found.begin(), found.end());
  } catch (const DataError& error) {
    // What the hash said already need not be said again; HDF5 was not handed the file then.
    const std::string problem = error.what();
    if (verification.ok() || problem.find(verification.problems.front()) == std::string::npos)
      verification.problems.push_back(problem);
  }
  return verification;
}

}  // namespace modebank
