#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/recording/ros_log.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// Recordings of ROS as a TableReader: one table per topic, one row per message.
class RecordingReader : public TableReader {
 public:
  /// `files`: one file, or parts in the order in which they were written. `definitions`: a folder of .msg files for
  /// types that are defined neither by the recording nor by the library; empty: none.
  RecordingReader(const std::vector<std::filesystem::path>& files, const std::filesystem::path& definitions);

  std::vector<TableInfo> tables() const override;
  InputFile describe(const std::vector<TableRequest>& requests) const override;
  std::vector<Table> read(const std::vector<TableRequest>& requests, InputFile* file) const override;
  std::string why_without(const std::string& column) const override;
  /// Topics that cannot be read. For Protobuf messages, lines of Python that read them.
  std::vector<std::string> left_out() const override;

 private:
  InputFile described(const UsedMessages& used) const;

  std::filesystem::path path_;
  RosLog log_;
};

}  // namespace modebank
