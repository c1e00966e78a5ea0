#include "io/import/open_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "io/arrays/array_reader.hpp"
#include "io/csv/csv.hpp"
#include "io/csv/csv_text.hpp"
#include "io/files/read_file.hpp"
#include "io/recording/recording_reader.hpp"
#include "io/recording/split_recording.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Path = std::filesystem::path;
using namespace std::string_view_literals;

constexpr std::size_t magic_bytes = 4096;

/// A readable format: a test of the file's first bytes (no test for a folder), and the reader.
struct Format {
  bool (*probe)(const Path& path, std::string_view first);
  std::shared_ptr<const TableReader> (*open)(const Path& path, const FormatOptions& options);
};

/// The formats in the order of their tests. Any other file is read as text.
constexpr std::array formats{
    Format{is_ros_log,
           [](const Path& path, const FormatOptions& options) -> std::shared_ptr<const TableReader> {
             return std::make_shared<RecordingReader>(recording_files(path), options.definitions);
           }},
    Format{[](const Path& path, std::string_view) { return is_hdf5(path); },
           [](const Path& path, const FormatOptions&) { return open_hdf5_tables(path); }},
    Format{[](const Path& path, std::string_view first) { return is_mat(path, first); },
           [](const Path& path, const FormatOptions&) { return open_mat_tables(path); }},
    Format{[](const Path&, std::string_view first) {
             return is_utf16(first) || first.find('\0') == std::string_view::npos;
           },
           [](const Path& path, const FormatOptions& options) -> std::shared_ptr<const TableReader> {
             return std::make_shared<CsvReader>(path, options);
           }},
};

/// Lines of Python that read a file into data frames and run modebank. docs/howto/formats.md contains the same
/// lines.
constexpr std::string_view px4_lines = R"(
from pyulog import ULog
import pandas, modebank
log = {d.name: pandas.DataFrame(d.data) for d in ULog("FILE").data_list}
frames = {"flight": (log["actuator_motors"], log["vehicle_angular_velocity"])}
archive = modebank.run(frames, state="xyz[2]", input=["control[0]", "control[1]"], time="timestamp",
                       **{"data.time_unit": "us", "data.split": "blocks 10"}))";
constexpr std::string_view ardupilot_lines = R"(
from pymavlink import mavutil
import pandas, modebank
log = mavutil.mavlink_connection("FILE")
rows = [m.to_dict() for m in iter(lambda: log.recv_match(type=["IMU", "RCOU"]), None)]
imu, motors = (pandas.DataFrame([r for r in rows if r["mavpackettype"] == name]) for name in ("IMU", "RCOU"))
archive = modebank.run({"flight": (motors, imu)}, state="GyrZ", input=["C1", "C3"], time="TimeUS", **{"data.split": "blocks 10"}))";
constexpr std::string_view telemetry_lines = R"(
from pymavlink import mavutil
import pandas, modebank
log = mavutil.mavlink_connection("FILE")
rows = [m.to_dict() for m in iter(lambda: log.recv_match(type=["RAW_IMU", "SERVO_OUTPUT_RAW"]), None)]
imu, motors = (pandas.DataFrame([r for r in rows if r["mavpackettype"] == name]) for name in ("RAW_IMU", "SERVO_OUTPUT_RAW"))
archive = modebank.run({"flight": (motors, imu)}, state="zgyro", input=["servo1_raw", "servo3_raw"], time="time_usec", **{"data.time_unit": "us", "data.split": "blocks 10"}))";
constexpr std::string_view parquet_lines = R"(
import pandas, modebank
frame = pandas.read_parquet("FILE")
archive = modebank.run({"drive": frame}, state="wz", input=["left", "right"], time="time", **{"data.split": "blocks 10"}))";
constexpr std::string_view arrow_lines = R"(
import pandas, modebank
frame = pandas.read_feather("FILE")
archive = modebank.run({"drive": frame}, state="wz", input=["left", "right"], time="time", **{"data.split": "blocks 10"}))";

/// A format that the program cannot read. It is recognised by its first bytes; a telemetry log, which has no fixed
/// first bytes, by is_telemetry.
struct Foreign {
  std::string_view magic, name, advice, python = {};
};

constexpr std::array foreign{
    Foreign{"version https://git-lfs.github.com/spec/"sv, "a Git LFS pointer to a file that was not fetched",
            "git lfs pull fetches it"},
    Foreign{"/annex/objects/"sv, "a git-annex pointer to a file that was not fetched", "git annex get '{0}'"},
    Foreign{"Octave-1-"sv, "in Octave's binary format",
            "octave --eval \"s = load('{0}'); save('-v7', '{0}.mat', '-struct', 's')\""},
    Foreign{"PAR1"sv, "an Apache Parquet file",
            "python3 -c \"import pandas; pandas.read_parquet('{0}').to_csv('{0}.csv')\"", parquet_lines},
    Foreign{"ARROW1"sv, "an Apache Arrow file",
            "python3 -c \"import pandas; pandas.read_feather('{0}').to_csv('{0}.csv')\"", arrow_lines},
    Foreign{"FEA1"sv, "an Apache Arrow file",
            "python3 -c \"import pandas; pandas.read_feather('{0}').to_csv('{0}.csv')\"", arrow_lines},
    Foreign{"\x80\x02"sv, "a Python pickle, which runs code when it is read", "write to_csv() where it was written"},
    Foreign{"\x80\x03"sv, "a Python pickle, which runs code when it is read", "write to_csv() where it was written"},
    Foreign{"\x80\x04"sv, "a Python pickle, which runs code when it is read", "write to_csv() where it was written"},
    Foreign{"\x80\x05"sv, "a Python pickle, which runs code when it is read", "write to_csv() where it was written"},
    Foreign{"PK\x03\x04"sv, "a zip archive (or an Excel workbook, or a NumPy .npz)",
            "unzip it, or save the table as CSV"},
    Foreign{"\xD0\xCF\x11\xE0"sv, "an old Excel workbook", "save the table as CSV"},
    Foreign{"\x93NUMPY"sv, "a NumPy array",
            "python3 -c \"import numpy; numpy.savetxt('{0}.csv', numpy.load('{0}'), delimiter=',')\""},
    Foreign{"\x1F\x8B"sv, "compressed by gzip", "gunzip -k '{0}'"},
    Foreign{"BZh"sv, "compressed by bzip2", "bunzip2 -k '{0}'"},
    Foreign{"\x28\xB5\x2F\xFD"sv, "compressed by Zstandard", "unzstd '{0}'"},
    Foreign{"\x04\x22\x4D\x18"sv, "compressed by LZ4", "unlz4 '{0}'"},
    Foreign{"\xFD\x37zXZ"sv, "compressed by xz", "unxz -k '{0}'"},
    Foreign{"ULog\x01\x12\x35"sv, "a PX4 log", "ulog2csv '{0}' writes one CSV per topic", px4_lines},
    Foreign{"\xA3\x95"sv, "an ArduPilot log", "mavlogdump.py --format csv '{0}'", ardupilot_lines},
    Foreign{""sv, "a MAVLink telemetry log", "mavlogdump.py --format csv '{0}'", telemetry_lines},
    Foreign{"MDF     "sv, "an ASAM MDF measurement", "asammdf's export to CSV reads it"},
    Foreign{"TDSm"sv, "a National Instruments TDMS file", "nptdms's tdmsinfo and as_dataframe().to_csv() read it"},
    Foreign{"%PDF"sv, "a PDF document", "export the table as CSV"},
    Foreign{"\x7F"
            "ELF"sv,
            "a program", "name the data"},
};

/// The default format of Octave's `save FILE`. A file with a single matrix can be read as text.
void refuse_octave_text(const Path& path, std::string_view first) {
  if (!first.starts_with("# Created by Octave")) return;
  const std::string content = read_file(path);
  const std::size_t name = content.find("\n# name: ");
  const bool one_matrix = content.find("\n# name: ", name + 1) == std::string::npos &&
                          content.find("\n# type: matrix\n") != std::string::npos;
  if (one_matrix && path.extension() != ".mat") return;
  throw ConfigurationError(
      fmt::format("{0} is in Octave's text format, which modebank does not read; octave --eval \"s = load('{0}'); "
                  "save('-v7', '{1}', '-struct', 's')\"",
                  path.string(), (path.parent_path() / (path.stem().string() + "_v7.mat")).string()));
}

/// A MAVLink telemetry log has no magic bytes. It begins with eight bytes of time, followed by a packet of version 1 or
/// 2.
bool is_telemetry(const Path& path, std::string_view first) {
  constexpr std::size_t time_bytes = 8;
  return path.extension() == ".tlog" && first.size() > time_bytes &&
         (first[time_bytes] == '\xFE' || first[time_bytes] == '\xFD');
}

std::string first_bytes(const Path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return {};
  std::ifstream stream = open_file(path);
  std::string first(magic_bytes, '\0');
  stream.read(first.data(), static_cast<std::streamsize>(first.size()));
  first.resize(static_cast<std::size_t>(stream.gcount()));
  return first;
}

/// Advice for a file: a command that converts the file, and lines of Python that read it, with example columns.
std::string advice_of(const Foreign& other, const std::string& path) {
  std::string advice = fmt::format(fmt::runtime(other.advice), path);
  if (other.python.empty()) return advice;
  const std::size_t at = other.python.find("FILE");
  return fmt::format("{}\nor use it in Python, with your topics and columns:{}{}{}", advice, other.python.substr(0, at),
                     path, other.python.substr(at + std::string_view("FILE").size()));
}

std::vector<unsigned> bytes_of(std::string_view first) {
  constexpr std::size_t shown = 8;
  std::vector<unsigned> bytes;
  for (const char c : first.substr(0, shown)) bytes.push_back(static_cast<unsigned char>(c));
  return bytes;
}

}  // namespace

std::shared_ptr<const TableReader> open_table(const Path& path, const FormatOptions& options) {
  const std::string first = first_bytes(path);
  for (const Foreign& other : foreign)
    if (other.magic.empty() ? is_telemetry(path, first) : first.starts_with(other.magic))
      throw ConfigurationError(fmt::format("{} is {}, which modebank does not read; {}", path.string(), other.name,
                                           advice_of(other, path.string())));
  refuse_octave_text(path, first);
  for (const Format& format : formats)
    if (format.probe(path, first)) return format.open(path, options);
  throw ConfigurationError(fmt::format("{} is neither text nor a known format; it begins with the bytes {:02X}",
                                       path.string(), fmt::join(bytes_of(first), " ")));
}

}  // namespace modebank
