#include "tests/support/piped_program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace modebank::test {

PipedProgram::PipedProgram(const std::vector<std::string>& arguments) {
  std::signal(SIGPIPE, SIG_IGN);
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const std::string errors = (folder_.path() / "err").string();
  child_ = fork();
  if (child_ < 0) throw std::runtime_error("fork failed");
  if (child_ == 0) {
    std::signal(SIGPIPE, SIG_DFL);
    std::signal(SIGINT, SIG_DFL);  // background processes of a shell ignore SIGINT
    const int file = open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (dup2(to[0], STDIN_FILENO) < 0 || dup2(from[1], STDOUT_FILENO) < 0 || dup2(file, STDERR_FILENO) < 0) _exit(126);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  close(to[0]);
  close(from[1]);
  to_ = to[1];
  from_ = from[0];
}

PipedProgram::~PipedProgram() {
  close_input();
  close_output();
  if (child_ < 0) return;
  kill(child_, SIGKILL);
  waitpid(child_, nullptr, 0);
}

void PipedProgram::write(const std::string& text) {
  if (::write(to_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    throw std::runtime_error("the program does not read");
}

std::optional<std::string> PipedProgram::read_line() {
  constexpr int patience_ms = 600'000;
  for (;;) {
    if (const auto end = buffer_.find('\n'); end != std::string::npos) {
      const std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      return line;
    }
    pollfd output{from_, POLLIN, 0};
    if (poll(&output, 1, patience_ms) <= 0) return std::nullopt;
    char chunk[4096];
    const ssize_t count = read(from_, chunk, sizeof chunk);
    if (count <= 0) return std::nullopt;
    buffer_.append(chunk, static_cast<std::size_t>(count));
  }
}

void PipedProgram::close_input() {
  if (to_ >= 0) close(to_);
  to_ = -1;
}

void PipedProgram::close_output() {
  if (from_ >= 0) close(from_);
  from_ = -1;
}

void PipedProgram::send_signal(int signal) const { kill(child_, signal); }

int PipedProgram::wait() {
  int status = 0;
  waitpid(child_, &status, 0);
  child_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string PipedProgram::errors() const {
  std::ostringstream text;
  text << std::ifstream(folder_.path() / "err", std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace modebank::test
