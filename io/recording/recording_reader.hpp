#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/recording/ros_log.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// Recordings of ROS as a TableReader. Each topic is a table, and each message is a row.
class RecordingReader : public TableReader {
 public:
  /// `files`: one file, or parts in the order of writing. `definitions`: a folder of .msg files for types that neither
  /// the recording nor the library defines. Empty: no folder.
  RecordingReader(const std::vector<std::filesystem::path>& files, const std::filesystem::path& definitions);

  std::vector<TableInfo> tables() const override;
  InputFile describe(const std::vector<TableRequest>& requests) const override;
  std::vector<Table> read(const std::vector<TableRequest>& requests, InputFile* file) const override;
  std::string why_without(const std::string& column) const override;
  /// Lists topics that cannot be read. For Protobuf messages, adds lines of Python that read them.
  std::vector<std::string> left_out() const override;

 private:
  InputFile described(const UsedMessages& used) const;

  std::filesystem::path path_;
  RosLog log_;
};

}  // namespace modebank
