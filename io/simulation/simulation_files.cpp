#include "io/simulation/simulation_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "io/files/csv_field.hpp"
#include "io/files/output_file.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

bool is_run_file(const std::string& name) {
  return (name.rfind("pro_", 0) == 0 || name.rfind("imu_", 0) == 0) && name.size() > 4 &&
         name.substr(name.size() - 4) == ".csv";
}

namespace {

namespace fs = std::filesystem;

std::string csv_text(const SimulationTable& table) {
  std::string text;
  for (std::size_t i = 0; i < table.names.size(); ++i) text += (i == 0 ? "" : ",") + quoted_field(table.names[i]);
  for (Eigen::Index k = 0; k < table.values.cols(); ++k) {
    for (Eigen::Index i = 0; i < table.values.rows(); ++i)
      fmt::format_to(std::back_inserter(text), "{}{}", i == 0 ? '\n' : ',', table.values(i, k));
    for (const auto& column : table.texts) text += "," + quoted_field(column[static_cast<std::size_t>(k)]);
  }
  return text + "\n";
}

std::vector<std::string> file_names(const char* kind, std::size_t runs) {
  const std::size_t digits = std::max<std::size_t>(2, fmt::formatted_size("{}", runs == 0 ? 0 : runs - 1));
  std::vector<std::string> names;
  for (std::size_t i = 0; i < runs; ++i) names.push_back(fmt::format("{}_{:0{}}.csv", kind, i, digits));
  return names;
}

void refuse_other_runs(const fs::path& folder, const std::set<std::string>& ours) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (is_run_file(name) && ours.count(name) == 0)
      throw ConfigurationError(
          fmt::format("{} has the file {}, which is not of this simulation and would be read as one of its runs; "
                      "remove it, or set another simulate.output",
                      folder.string(), name));
  }
}

/// The column names in a file's first line. Empty if the file does not exist.
std::set<std::string> columns_of(const fs::path& path) {
  constexpr std::size_t longest = 1 << 16;
  if (!fs::is_regular_file(path)) return {};
  std::string line(longest, '\0');
  std::ifstream stream = open_file(path);
  stream.read(line.data(), static_cast<std::streamsize>(longest));
  line.resize(static_cast<std::size_t>(stream.gcount()));
  std::set<std::string> names;
  std::string name;
  bool quoted = false;
  for (const char c : line.substr(0, line.find('\n')) + ',') {
    if (c == '"')
      quoted = !quoted;
    else if (c != ',' || quoted)
      name += c;
    else
      names.insert(std::exchange(name, {}));
  }
  return names;
}

bool has_truth(const std::set<std::string>& columns) {
  return columns.count("mode") > 0 &&
         std::any_of(columns.begin(), columns.end(), [](const auto& name) { return name.starts_with("true_"); });
}

/// Whether a run's two files come from a simulation. One file must have truth columns, and the other file the columns
/// to which these belong.
bool is_simulated(const fs::path& path) {
  const std::set<std::string> columns = columns_of(path);
  if (has_truth(columns)) return true;
  const std::string name = path.filename().string(), other = (name.starts_with("pro") ? "imu" : "pro") + name.substr(3);
  const std::set<std::string> truth = columns_of(path.parent_path() / other);
  return has_truth(truth) && std::all_of(columns.begin(), columns.end(), [&](const std::string& column) {
           return column == "time" || truth.count("true_" + column.substr(column.starts_with("cmd_") ? 4 : 0)) > 0;
         });
}

/// A folder inside the target, on the same file system. The destructor removes this folder. If this object also created
/// the target and the target is empty, it removes the target too.
class StagingFolder {
 public:
  explicit StagingFolder(const fs::path& target) : target_(target) {
    std::error_code error;
    made_target_ = fs::create_directory(target, error);  // not an error if the folder exists
    if (!error && !fs::is_directory(target)) error = std::make_error_code(std::errc::not_a_directory);
    remove_leftovers(target);
    path_ = temporary_path(target / "simulation");
    if (!error) fs::create_directory(path_, error);
    if (!error) return;
    remove();
    const std::string what = fmt::format("cannot make folder {}: {}", target.string(), error.message());
    if (is_disk_failure(error)) throw DataError(what);
    throw ConfigurationError(what);
  }
  ~StagingFolder() { remove(); }
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  void remove() const {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    if (made_target_) fs::remove(target_, ignored);  // removes the folder only if it is empty
  }

  fs::path target_, path_;
  bool made_target_ = false;
};

void check_targets(const fs::path& folder, const std::vector<std::string>& names) {
  refuse_other_runs(folder, {names.begin(), names.end()});
  for (const std::string& name : names)
    if (fs::exists(folder / name))
      check_output({"simulate.output", folder / name, {"a simulated run", is_simulated}}, {});
}

/// Moves the files to their final paths. Old files are kept until all files are moved. If a move fails, they are
/// restored.
void move_all(const fs::path& from, const fs::path& to, const std::vector<std::string>& names) {
  const auto kept = [&](const std::string& name) { return from / (name + ".before"); };
  std::size_t moved = 0;
  try {
    for (; moved < names.size(); ++moved) {
      const std::string& name = names[moved];
      if (fs::exists(to / name)) fs::copy_file(to / name, kept(name));
      fs::rename(from / name, to / name);
    }
  } catch (const fs::filesystem_error& error) {
    std::error_code ignored;
    while (moved-- > 0) {
      if (fs::exists(kept(names[moved]), ignored))
        fs::rename(kept(names[moved]), to / names[moved], ignored);
      else
        fs::remove(to / names[moved], ignored);
    }
    throw DataError(fmt::format("cannot write {}: {}", (error.path2().empty() ? to : error.path2()).string(),
                                error.code().message()));
  }
}

}  // namespace

void check_column_names(const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].empty() || std::count(names.begin(), names.end(), names[i]) > 1)
      throw ConfigurationError(
          fmt::format("simulated file: the name \"{1}\" of column {0} is empty or occurs twice", i + 1, names[i]));
}

void write_simulation_files(const fs::path& folder, std::size_t runs,
                            const std::function<SimulationTables(std::size_t)>& tables_of) {
  const std::vector<std::string> inputs = file_names("pro", runs), states = file_names("imu", runs);
  std::vector<std::string> all = inputs;
  all.insert(all.end(), states.begin(), states.end());
  const StagingFolder staging(folder);
  check_targets(folder, all);
  for (std::size_t i = 0; i < runs; ++i) {
    const SimulationTables tables = tables_of(i);
    write_staged(staging.path() / inputs[i], folder / inputs[i], csv_text(tables.inputs));
    write_staged(staging.path() / states[i], folder / states[i], csv_text(tables.states));
  }
  move_all(staging.path(), folder, all);
}

}  // namespace modebank
