#include "app/study/run/worker_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>

#include "app/study/run/study_worker.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

[[noreturn]] void fail(const char* what, int reason) {
  throw DataError(fmt::format("cannot {} a worker: {}", what, std::generic_category().message(reason)));
}

}  // namespace

TaskFile::TaskFile(const std::string& bytes) : descriptor_(::memfd_create("modebank-study", MFD_CLOEXEC)) {
  if (descriptor_ < 0) fail("make the task of", errno);
  for (std::size_t written = 0; written < bytes.size();) {
    const ssize_t more = ::write(descriptor_, bytes.data() + written, bytes.size() - written);
    if (more < 0 && errno != EINTR) fail("write the task of", errno);
    if (more > 0) written += static_cast<std::size_t>(more);
  }
}

TaskFile::~TaskFile() { ::close(descriptor_); }

WorkerProcess::WorkerProcess(const TaskFile& task, std::size_t first) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("make a pipe to", errno);
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  const std::string parent = std::to_string(::getpid()), place = std::to_string(first);
  std::array<const char*, 5> words{"modebank", worker_word, parent.c_str(), place.c_str(), nullptr};
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, task.descriptor(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  // The link always leads to the running program, even if an update has replaced the program's file.
  const int error =
      ::posix_spawn(&process_, "/proc/self/exe", &actions, nullptr, const_cast<char* const*>(words.data()), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  channel_ = ends[0];
  if (error == 0) return;
  ::close(channel_);
  fail("start", error);
}

WorkerProcess::~WorkerProcess() {
  kill();
  ::close(channel_);
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) continue;
}

void WorkerProcess::kill() const { ::kill(process_, SIGKILL); }

std::optional<std::vector<std::string>> WorkerProcess::read_lines() {
  std::array<char, 1 << 14> block;
  ssize_t bytes = 0;
  bool ended = false;
  while (!ended) {
    bytes = ::read(channel_, block.data(), block.size());
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes < 0) break;  // there are no more data at present
    ended = bytes == 0;
    unread_.append(block.data(), static_cast<std::size_t>(bytes));
  }
  std::vector<std::string> lines;
  for (std::size_t at = unread_.find('\n'); at != std::string::npos; at = unread_.find('\n')) {
    lines.push_back(unread_.substr(0, at));
    unread_.erase(0, at + 1);
  }
  if (ended && lines.empty()) return std::nullopt;
  return lines;
}

std::string WorkerProcess::end() const {
  siginfo_t about{};
  while (::waitid(P_PID, static_cast<id_t>(process_), &about, WEXITED | WNOWAIT) < 0 && errno == EINTR) continue;
  if (about.si_code == CLD_EXITED && about.si_status == 0) return {};
  if (about.si_code == CLD_EXITED) return fmt::format("its process ended with status {}", about.si_status);
  return fmt::format("its process was ended by signal {} ({})", about.si_status, ::strsignal(about.si_status));
}

}  // namespace modebank::app
