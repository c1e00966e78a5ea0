#include "io/archive.hpp"

#include "ident/error.hpp"
#include "io/archive_file.hpp"
#include "io/archive_layout.hpp"
#include "io/archive_reader.hpp"
#include "io/archive_writer.hpp"
#include "io/read_stages.hpp"
#include "io/replace_file.hpp"
#include "io/run_names.hpp"
#include "io/sha256.hpp"
#include "io/user_block.hpp"

namespace modebank {

void check_writable(const std::filesystem::path& path) {
  if (const std::string obstacle = write_obstacle(path); !obstacle.empty())
    throw ConfigurationError("cannot write " + path.string() + ": " + obstacle);
}

void write_archive(const std::filesystem::path& path, const Archive& archive) {
  if (archive.recording) check_run_names(run_names(archive.recording->runs));
  const hdf5::Quiet quiet;
  const ArchiveImage image;
  {
    ArchiveWriter root(open_root(image.file()));
    layout::exchange_archive(root, archive);
  }
  const std::string_view content = image.content();
  const UserBlock block = make_user_block(sha256_hex(content));
  replace_file(path, {std::string_view(block.data(), block.size()), content});
}

Archive read_archive(const std::filesystem::path& path) {
  const hdf5::Quiet quiet;
  const hdf5::Handle file = open_archive(path);
  if (const std::vector<std::string> problems = hash_problems(path); !problems.empty())
    throw DataError(path.string() + ": damaged: " + problems.front());
  try {
    return read_stages(file, nullptr);
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  }
}

Archive read_stages(const hdf5::Handle& file, std::vector<std::string>* problems) {
  Archive archive;
  ArchiveReader root(open_root(file), problems);
  layout::exchange_archive(root, archive);
  return archive;
}

}  // namespace modebank
