// Recordings of ROS, and the list of a recording in parts.

#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/read_table.hpp"
#include "tests/fuzz/scratch.hpp"
#include "tests/fuzz/some_recording.hpp"
#include "tests/fuzz/target.hpp"

namespace modebank::fuzz {

namespace {

constexpr char bag_name[] = "fuzz.bag", mcap_name[] = "fuzz.mcap", db3_name[] = "fuzz.db3";

/// metadata.yaml of a folder whose two parts are there.
void read_parts(std::string_view text) {
  static const std::filesystem::path folder = [] {
    std::filesystem::create_directories(scratch("parts"));
    Random random(3);
    scratch_file("parts/a.mcap", some_mcap(random));
    scratch_file("parts/b.mcap", some_mcap(random));
    return scratch("parts");
  }();
  scratch_file("parts/metadata.yaml", text);
  Random chances = chances_of(text);
  read_all_tables(folder, chances);
}

}  // namespace

std::vector<Target> recording_targets() {
  constexpr std::uint64_t million = 1'000'000, few = 100'000;
  const std::vector<std::string> yaml_tokens{
      "relative_file_paths:",  "- ", "a.mcap", "b.mcap", "../", "\"", "'", "files:", "path: ", "[a.mcap, b.mcap]", ":",
      "compression_mode: FILE"};
  return {{"bag", million, some_bag, read_as_file<bag_name>},
          {"mcap", million, some_mcap, read_as_file<mcap_name>},
          {"db3", few, some_db3, read_as_file<db3_name>},
          {"parts", few,
           [yaml_tokens](Random& random) {
             static const auto texts = corpus("parts");
             return mutated_text(random, texts, yaml_tokens);
           },
           read_parts}};
}

}  // namespace modebank::fuzz
