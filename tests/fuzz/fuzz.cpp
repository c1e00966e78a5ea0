// fuzz TARGET|all [--seed S] [--first I] [--count N | --seconds T | --part SHARE] [--findings FOLDER]
// fuzz TARGET FILE...
//
// Runs readers of the program in process under mutated inputs. --seconds: by the clock, for all targets together;
// --count: inputs of each; --part: this share of each target's whole campaign. With files: those, as they are.
#include <fmt/format.h>
#include <hdf5.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "tests/fuzz/scratch.hpp"
#include "tests/fuzz/supervise.hpp"
#include "tests/support/paths.hpp"

#ifdef __SANITIZE_ADDRESS__
// An allocation beyond what an input may cost is an exception, as on a machine that has no more; what is freed is soon
// used again, lest it count. HDF5 1.10 leaks inside where metadata are damaged, and so does libmatio.
extern "C" const char* __asan_default_options() {  // NOLINT
  return "max_allocation_size_mb=800:allocator_may_return_null=1:quarantine_size_mb=16:hard_rss_limit_mb=2500";
}
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\nleak:libmatio\nleak:libtbb\n"; }  // NOLINT
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }                             // NOLINT
#endif

namespace modebank::fuzz {

std::vector<Target> joined(std::initializer_list<std::vector<Target> (*)()> parts) {
  std::vector<Target> all;
  for (auto* part : parts)
    for (Target& target : part()) all.push_back(std::move(target));
  return all;
}

std::vector<std::string> corpus(const std::string& name) {
  const std::filesystem::path folder = test::project_dir() / "tests" / "fuzz" / "corpus" / name;
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<std::string> inputs;
  for (const auto& file : files) inputs.push_back(content_of(file));
  return inputs;
}

namespace {

struct Arguments {
  std::string target;
  std::vector<std::string> files;
  Effort effort;
  double part = 0.0;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] {
      if (++i >= argc) throw std::invalid_argument(word + " lacks its value");
      return std::string(argv[i]);
    };
    if (word == "--seed")
      arguments.effort.seed = std::stoull(value());
    else if (word == "--first")
      arguments.effort.first = std::stoull(value());
    else if (word == "--count")
      arguments.effort.count = std::stoull(value());
    else if (word == "--seconds")
      arguments.effort.seconds = std::stod(value());
    else if (word == "--part")
      arguments.part = std::stod(value());
    else if (word == "--findings")
      arguments.effort.findings = value();
    else if (arguments.target.empty())
      arguments.target = word;
    else
      arguments.files.push_back(word);
  }
  if (arguments.target.empty()) throw std::invalid_argument("which target, or all?");
  return arguments;
}

std::vector<Target> chosen(const std::string& name) {
  std::vector<Target> targets;
  std::string names;
  for (Target& target : all_targets()) {
    names += " " + target.name;
    if (name == "all" || name == target.name) targets.push_back(std::move(target));
  }
  if (targets.empty()) throw std::invalid_argument("no target " + name + "; there are all" + names);
  return targets;
}

int run(const Arguments& arguments) {
  const std::vector<Target> targets = chosen(arguments.target);
  bool fine = true;
  if (!arguments.files.empty()) {
    for (const std::string& file : arguments.files) {
      std::ifstream stream(file, std::ios::binary);
      if (!stream) throw std::invalid_argument("cannot read " + file);
      fine = replay(targets.front(), std::string(std::istreambuf_iterator<char>(stream), {}), file) && fine;
    }
    return fine ? 0 : 1;
  }
  fmt::print("{:12} {:>9} {:>9} {:>9} {:>8} {:>12} {:>10} {:>8}\n", "target", "inputs", "taken", "refused", "findings",
             "processor s", "slowest s", "grown MB");
  for (const Target& target : targets) {
    Effort effort = arguments.effort;
    if (arguments.part > 0.0)
      effort.count = static_cast<std::uint64_t>(arguments.part * static_cast<double>(target.inputs));
    if (effort.seconds > 0.0) effort.seconds /= static_cast<double>(targets.size());
    if (effort.seconds > 0.0 && effort.count == 0) effort.count = std::numeric_limits<std::uint64_t>::max() / 2;
    const Outcome outcome = fuzz(target, effort);
    fmt::print("{:12} {:9} {:9} {:9} {:8} {:12.1f} {:10.3f} {:8.0f}\n", target.name, outcome.inputs, outcome.taken,
               outcome.refused, outcome.findings, outcome.processor_s, outcome.slowest_s, outcome.most_megabytes);
    std::fflush(stdout);
    fine = fine && outcome.findings == 0;
  }
  return fine ? 0 : 1;
}

}  // namespace

}  // namespace modebank::fuzz

int main(int argc, char** argv) {
  using namespace modebank;
  // Memory where there is some: most targets write a file per input.
  if (std::filesystem::is_directory("/dev/shm")) setenv("TMPDIR", "/dev/shm", 0);
  spdlog::set_level(spdlog::level::off);
  H5dont_atexit();  // what the mutators cannot close of files that they broke is no reader's fault
  try {
    const test::TemporaryFolder folder;
    fuzz::set_scratch_folder(folder.path());
    return fuzz::run(fuzz::parse(argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "fuzz: {}\n", error.what());
    return 2;
  }
}
