#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ident/data/run_labels.hpp"
#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/lag/report.hpp"
#include "io/files/input_file.hpp"
#include "io/import/memory_tables.hpp"
#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

struct ImportedData {
  Recording recording;              ///< runs in byte order of their names, with roles
  std::vector<InputFile> files;     ///< in the order of runs, inputs before states
  std::vector<std::string> notes;   ///< remarks on the data for the user
  std::optional<RunLabels> labels;  ///< with DataOptions::label
  std::optional<LagReport> lag;     ///< the estimated and applied lag; only with DataOptions::lag_auto
  double step_scatter = 0.0;        ///< LogSampling::step_scatter
  std::string data_hash;            ///< hash of the files (io/files/input_file.hpp)
};

/// Finds, checks and reads all runs.
/// - Throws ConfigurationError for errors that are found before samples are read: a pattern without a match, a missing
/// states file, an empty file, a missing column (the message lists the existing columns), an unknown run.
/// - Throws DataError with file and line for bad content: text in a number, NaN, time not increasing, too few samples,
/// streams that do not overlap, unequal numbers of rows under Join::row.
/// - If `memory` is given, its tables are the runs. data.root, data.inputs and data.states are then ignored.
/// - `learned`: the same as in choose_sampling (io/import/sampling.hpp), for data on which an existing bank is judged.
ImportedData import_data(const DataOptions& options, const MemoryTables* memory = nullptr,
                         const AveragedColumns* learned = nullptr);

/// The streams of all runs as they are in the files, for checks. Samples are not sorted. Missing values and times are
/// NaN. Roles are set, and runs are sorted by name. Throws the same exceptions as import_data, except for errors that
/// data.missing and data.disorder handle.
std::vector<RunStreams> read_streams(const DataOptions& options);

/// A file that import_data would read.
struct DataFile {
  std::filesystem::path path;
  std::vector<std::string> tables = {};  ///< the tables to read; sorted, because the file's hash depends on their order
  std::function<InputFile()> describe =
      {};  ///< the file's entry in ImportedData::files; throws if the file cannot be read
};

/// All files, in the order of ImportedData::files. Throws ConfigurationError in the same cases as import_data.
std::vector<DataFile> data_files(const DataOptions& options);

}  // namespace modebank
