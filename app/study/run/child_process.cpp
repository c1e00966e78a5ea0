#include "app/study/run/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// The first byte of an answer tells what follows it.
constexpr char result_mark = 'r', configuration_mark = 'c', data_mark = 'd', other_mark = 'o';

std::string answer_of(const std::function<std::string()>& work) {
  try {
    return result_mark + work();
  } catch (const ConfigurationError& error) {
    return std::string(1, configuration_mark) + error.what();
  } catch (const DataError& error) {
    return std::string(1, data_mark) + error.what();
  } catch (const std::exception& error) {
    return std::string(1, other_mark) + error.what();
  }
}

[[noreturn]] void send_answer(int channel, const std::string& answer) {
  for (std::size_t sent = 0; sent < answer.size();) {
    const ssize_t bytes = ::write(channel, answer.data() + sent, answer.size() - sent);
    if (bytes < 0 && errno != EINTR) break;
    if (bytes > 0) sent += static_cast<std::size_t>(bytes);
  }
  ::_exit(0);  // what the parent will do at its exit is not the child's to do
}

std::string receive_answer(int channel) {
  std::string answer;
  std::array<char, 1 << 14> block;
  for (;;) {
    const ssize_t bytes = ::read(channel, block.data(), block.size());
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes <= 0) return answer;
    answer.append(block.data(), static_cast<std::size_t>(bytes));
  }
}

}  // namespace

pid_t fork_child() {
  const pid_t parent = ::getpid();
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw DataError("cannot start a process: " + std::generic_category().message(errno));
  if (child > 0) return child;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // it was gone before that took effect
  return 0;
}

std::string in_own_process(const std::function<std::string()>& work) {
  std::array<int, 2> channel{};
  if (::pipe2(channel.data(), O_CLOEXEC) != 0)
    throw DataError("cannot make a pipe to a process: " + std::generic_category().message(errno));
  const pid_t child = fork_child();
  if (child == 0) send_answer(channel[1], answer_of(work));
  ::close(channel[1]);
  const std::string answer = receive_answer(channel[0]);
  ::close(channel[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (answer.empty() || WIFSIGNALED(status)) throw DataError("the data could not be read: " + how_it_ended(status));
  const std::string text = answer.substr(1);
  if (answer.front() == configuration_mark) throw ConfigurationError(text);
  if (answer.front() == data_mark) throw DataError(text);
  if (answer.front() == other_mark) throw std::runtime_error(text);
  return text;
}

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("its process was ended by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
  return fmt::format("its process ended with status {}", WEXITSTATUS(status));
}

}  // namespace modebank::app
