#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace modebank {

/// A process as others may come across it on a shared file system: the number alone says nothing on another machine,
/// after a restart, or in another container.
struct ProcessIdentity {
  std::string host;
  std::string boot;              ///< the kernel's identifier of this boot; empty where it gives none
  std::string space;             ///< of process numbers (a container has its own); empty where it is not known
  std::int64_t process = 0;      ///< its number
  std::uint64_t start_tick = 0;  ///< when it began, in ticks since boot: numbers are given again; 0 where not known

  bool operator==(const ProcessIdentity&) const = default;
};

/// Of the calling process, asked anew at each call: it may have been forked.
ProcessIdentity this_process();

/// What a process has become, as far as this one can tell.
enum class ProcessState {
  living,
  gone,
  unknown  ///< of another machine, boot or container
};
ProcessState state_of(const ProcessIdentity& process);

/// As a word for names of files and for lines of a log: HOST~BOOT~SPACE~PROCESS~TICK, without blanks or slashes.
std::string process_word(const ProcessIdentity& process);
/// Reads it back; nothing for other texts.
std::optional<ProcessIdentity> parse_process_word(std::string_view word);

/// What the name of a temporary file says.
struct TemporaryName {
  std::string target;  ///< the name of the file that it was to become; the first part of a very long one
  ProcessIdentity owner;
};

/// A path in the folder of `target` that no other process or thread on any machine takes:
/// .TARGET~HOST~BOOT~SPACE~PROCESS~TICK~NUMBER.tmp
std::filesystem::path temporary_path(const std::filesystem::path& target);
/// Of a file's name without its folder; nothing for names that temporary_path does not make.
std::optional<TemporaryName> parse_temporary_name(std::string_view name);

/// Removes the temporary files and folders of processes that are certainly gone (state_of) and says how many it were.
/// What cannot be read or removed stays, in silence: nothing depends on it.
std::size_t remove_leftovers(const std::filesystem::path& folder);

}  // namespace modebank
