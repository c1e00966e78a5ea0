#include "app/view/catalogue.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <memory>
#include <system_error>

#include "io/files/sha256.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app::view {
namespace {

namespace fs = std::filesystem;

constexpr int folder_flags = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
// A pipe in the folder must not make us wait for who writes into it.
constexpr int file_flags = O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC;

std::string id_of(const fs::path& name) { return sha256_hex(name.string()).substr(0, 16); }

FileState state_of(const struct stat& found) {
  constexpr std::int64_t ns_per_s = 1'000'000'000;
  return {found.st_dev, found.st_ino, static_cast<std::uintmax_t>(found.st_size),
          found.st_mtim.tv_sec * ns_per_s + found.st_mtim.tv_nsec};
}

OpenFile open_in(int folder, const fs::path& name, int flags) {
  const int file = ::openat(folder, name.c_str(), flags);
  return file < 0 ? OpenFile() : OpenFile(file);
}

}  // namespace

Catalogue::Catalogue(const fs::path& what) {
  std::error_code error;
  const fs::path path = fs::canonical(what, error);  // what the user names may be a link
  if (error) throw ConfigurationError(fmt::format("{}: {}", what.string(), error.message()));
  const bool folder = fs::is_directory(path);
  if (!folder) only_ = path.filename();
  root_ = open_in(AT_FDCWD, folder ? path : path.parent_path(), folder_flags);
  if (!root_) throw ConfigurationError(fmt::format("{}: {}", what.string(), std::generic_category().message(errno)));
  title_ = path.filename().string();
  look();
  if (!folder && entries_.empty()) throw ConfigurationError(what.string() + ": not a regular file");
}

void Catalogue::take(int folder, const fs::path& name, std::map<std::string, Entry>& found) {
  struct stat status {};
  if (::fstatat(folder, name.filename().c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(status.st_mode)) return;
  if (found.size() >= largest) {
    cut_ = true;
    return;
  }
  Entry entry;
  entry.id = id_of(name);
  entry.name = name;
  entry.state = state_of(status);
  if (const Entry* known = find(entry.id); known && known->state == entry.state)
    entry = *known;
  else
    changed();
  found.emplace(entry.id, entry);
}

void Catalogue::look_into(int folder, const fs::path& name, int depth, std::map<std::string, Entry>& found) {
  // The stream closes its descriptor; ours stays open.
  const std::unique_ptr<DIR, int (*)(DIR*)> list(::fdopendir(::openat(folder, ".", folder_flags)), ::closedir);
  if (!list) return;
  while (const dirent* member = ::readdir(list.get())) {
    const fs::path file = member->d_name;
    if (file.string().front() == '.') continue;  // hidden, temporary, and the way up
    if (file.extension() == ".h5") {
      take(folder, name / file, found);
    } else if (depth > 0 && (member->d_type == DT_DIR || member->d_type == DT_UNKNOWN)) {
      if (const OpenFile below = open_in(folder, file, folder_flags))
        look_into(below.descriptor(), name / file, depth - 1, found);
    }
  }
}

void Catalogue::look() {
  std::map<std::string, Entry> found;
  cut_ = false;
  if (is_one_archive())
    take(root_.descriptor(), only_, found);
  else
    look_into(root_.descriptor(), {}, deepest, found);
  for (const auto& [id, entry] : entries_)
    if (!found.count(id)) changed();
  entries_ = std::move(found);
}

const Entry* Catalogue::find(const std::string& id) const {
  const auto found = entries_.find(id);
  return found == entries_.end() ? nullptr : &found->second;
}

NamedFile Catalogue::open(const Entry& entry) const {
  OpenFile folder = root_;
  for (const fs::path& part : entry.name.parent_path()) {
    folder = open_in(folder.descriptor(), part, folder_flags);
    if (!folder) return {};
  }
  OpenFile file = open_in(folder.descriptor(), entry.name.filename(), file_flags);
  struct stat status {};
  if (!file || ::fstat(file.descriptor(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return {file, entry.name};
}

}  // namespace modebank::app::view
