#pragma once

#include <string>
#include <vector>

#include "io/import/import.hpp"
#include "modebank/base/error.hpp"
#include "tests/io/import/expect_error.hpp"
#include "tests/support/paths.hpp"

namespace modebank::test {

/// A folder of small files, and options that read pro_*.csv (time, u) and imu_*.csv (time, x).
class ImportFixture : public ::testing::Test {
 protected:
  ImportFixture() {
    options.root = folder.path().string();
    options.inputs = "pro_*.csv";
    options.states = "imu_*.csv";
    options.state = {"x"};
    options.input = {"u"};
  }

  void write(const std::string& name, const std::string& content) const { write_file(folder.path() / name, content); }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }

  /// Writes a run with the inputs 10, 20, 30 at 0, 1, 2 s, and the states 0 to 4 at every half second.
  void write_run(const std::string& name) const {
    write("pro_" + name + ".csv", "time,u\n0,10\n1,20\n2,30\n");
    write("imu_" + name + ".csv", "time,x\n0,0\n0.5,1\n1,2\n1.5,3\n2,4\n");
  }

  ImportedData import() const { return import_data(options); }
  template <class Error>
  std::string error() const {
    return message_of<Error>([&] { import_data(options); });
  }
  static std::vector<std::string> names(const ImportedData& data) {
    std::vector<std::string> result;
    for (const Trajectory& run : data.recording.runs) result.push_back(run.run);
    return result;
  }
  static std::vector<std::string> names(const ImportedData& data, Role role) {
    std::vector<std::string> result;
    for (const Trajectory& run : data.recording.runs)
      if (run.role == role) result.push_back(run.run);
    return result;
  }

  TemporaryFolder folder;
  DataOptions options;
};

/// A row of numbers that are the signal of one channel.
inline Eigen::MatrixXd row(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::RowVectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace modebank::test
