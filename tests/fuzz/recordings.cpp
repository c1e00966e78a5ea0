// Reads ROS recordings: bags, MCAP files, payloads in SQLite, and the list of a recording's parts.
#include "tests/fuzz/entry.hpp"
#include "tests/fuzz/read_log.hpp"
#include "tests/support/paths.hpp"

namespace modebank::fuzz {

namespace {

void read_recording(const char* name, std::string_view bytes) {
  read_log(scratch_file(name, bytes), FormatOptions(), bytes.size());
}

void read_bag(std::string_view bytes) { read_recording("fuzz.bag", bytes); }
void read_mcap(std::string_view bytes) { read_recording("fuzz.mcap", bytes); }
void read_db3(std::string_view bytes) { read_recording("fuzz.db3", bytes); }

/// The metadata.yaml of a folder with two parts.
void read_parts(std::string_view text) {
  const std::filesystem::path file = scratch_file("metadata.yaml", text),
                              part = test::project_dir() / "tests/fuzz/corpus/mcap/plain.mcap";
  for (const char* name : {"a.mcap", "b.mcap"})
    std::filesystem::copy_file(part, file.parent_path() / name, std::filesystem::copy_options::skip_existing);
  read_log(file.parent_path(), FormatOptions(), text.size());
}

const Entry bag("bag", read_bag), mcap("mcap", read_mcap), db3("db3", read_db3), parts("parts", read_parts);

}  // namespace

}  // namespace modebank::fuzz
