#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace modebank {

/// One CSV file: a name and a row of values per column.
struct SimulationTable {
  std::vector<std::string> names;
  Eigen::MatrixXd values;                            ///< columns x samples
  std::vector<std::vector<std::string>> texts = {};  ///< further columns, named by the last names
};

/// The two files of a run.
struct SimulationTables {
  SimulationTable inputs;  ///< pro_NN.csv
  SimulationTable states;  ///< imu_NN.csv
};

/// Throws ConfigurationError when a column's name is empty or there twice.
void check_column_names(const std::vector<std::string>& names);

/// Whether a file is named as those below are: pro_*.csv or imu_*.csv.
bool is_run_file(const std::string& name);

/// Writes pro_NN.csv and imu_NN.csv of `runs` runs, numbers in their shortest form that reads back exactly. All files
/// or none: they are written to a folder beside the old ones and moved when all are complete. The folder is made if its
/// parent exists. Throws ConfigurationError when it cannot be made, holds pro_ or imu_ files that would stay, because
/// `run` would read them as further runs, or files of these names that are no simulated run.
void write_simulation_files(const std::filesystem::path& folder, std::size_t runs,
                            const std::function<SimulationTables(std::size_t)>& tables_of);

}  // namespace modebank
