#include <vector>

#include "ident/error.hpp"
#include "io/archive.hpp"
#include "io/archive_file.hpp"
#include "io/read_stages.hpp"
#include "io/user_block.hpp"

namespace modebank {

Verification verify_archive(const std::filesystem::path& path) {
  require_readable(path);
  const hdf5::Quiet quiet;
  Verification verification{hash_problems(path)};
  try {
    const hdf5::Handle file = open_archive(path);
    std::vector<std::string> found;
    read_stages(file, &found);
    verification.problems.insert(verification.problems.end(), found.begin(), found.end());
  } catch (const DataError& error) {
    verification.problems.emplace_back(error.what());
  }
  return verification;
}

}  // namespace modebank
