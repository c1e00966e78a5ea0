#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/view/message.hpp"

namespace modebank::app::view {

/// What an archive may cost, whoever made it: the demo's page takes 128 MB of addresses and 0.2 s.
inline constexpr long child_memory_MB = 512, child_file_MB = 256;
inline constexpr std::chrono::seconds child_time{20};

/// An open archive, and the name that it has for who reads it (relative, without "..").
struct NamedFile {
  OpenFile file;
  std::filesystem::path name;
};

/// This program once more, on archives that may be made to harm it: with limits, without the server's secrets and
/// sockets, and seeing of the folder no more than the files it is given, as ./NAME in its working folder. Its output is
/// FOLDER/out and FOLDER/err, what it writes elsewhere is up to its arguments (../FILE is FOLDER/FILE).
class Child {
 public:
  /// `folder` is new and empty.
  Child(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
        const std::vector<NamedFile>& files);
  ~Child();  ///< kills it
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Whether it has ended, or has now been ended because its time is over.
  bool ended();
  /// Why there is no result; empty where it did all it should.
  std::string failure() const;

 private:
  std::filesystem::path folder_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  pid_t process_ = -1;
  int status_ = 0;
  bool late_ = false;
};

/// Between fork and exec: no file and no socket of ours is open in what runs next.
void hand_on_nothing();

/// The first bytes of a file; empty where it cannot be read.
std::string beginning_of(const std::filesystem::path& path, std::size_t bytes);

}  // namespace modebank::app::view
