#include "app/view/child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <system_error>

namespace modebank::app::view {
namespace {

namespace fs = std::filesystem;

constexpr rlim_t bytes_per_MB = 1024 * 1024;

void limit(int resource, rlim_t value) {
  const rlimit both{value, value};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

void limit_all() {
  limit(RLIMIT_AS, child_memory_MB * bytes_per_MB);
  limit(RLIMIT_FSIZE, child_file_MB * bytes_per_MB);
  limit(RLIMIT_CPU, static_cast<rlim_t>(child_time.count()));
  limit(RLIMIT_CORE, 0);
}

/// What the new process does before it is this program again: nothing here allocates.
[[noreturn]] void become(const char* folder, char* const* argv, const std::vector<NamedFile>& files, pid_t parent) {
  const int nothing = ::open("/dev/null", O_RDONLY), nowhere = ::chdir(folder);
  const int out = ::open("../out", O_WRONLY | O_CREAT | O_EXCL, 0600);
  const int err = ::open("../err", O_WRONLY | O_CREAT | O_EXCL, 0600);
  if (nowhere != 0 || ::dup2(nothing, 0) < 0 || ::dup2(out, 1) < 0 || ::dup2(err, 2) < 0) ::_exit(126);
  hand_on_nothing();
  for (const NamedFile& each : files) ::fcntl(each.file.descriptor(), F_SETFD, 0);  // these alone are handed on
  ::setpgid(0, 0);                                                                  // Ctrl-C is for the server
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);                                               // a killed server leaves nobody
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  if (::getppid() != parent) ::_exit(126);
  limit_all();
  ::execv("/proc/self/exe", argv);
  ::_exit(127);
}

}  // namespace

void hand_on_nothing() {
  constexpr int most = 1024;  // the server has far fewer open
  for (int file = 3; file < most; ++file) ::fcntl(file, F_SETFD, FD_CLOEXEC);
}

Child::Child(const fs::path& folder, const std::vector<std::string>& arguments, const std::vector<NamedFile>& files)
    : folder_(folder) {
  const fs::path inside = folder / "in";
  fs::create_directory(inside);
  for (const NamedFile& each : files) {
    fs::create_directories((inside / each.name).parent_path());
    // The open file itself, whatever may have taken its name since.
    fs::create_symlink(fmt::format("/proc/self/fd/{}", each.file.descriptor()), inside / each.name);
  }
  std::string program = "modebank";
  std::vector<char*> argv{program.data()};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ < 0) throw std::system_error(errno, std::generic_category(), "cannot start a process");
  if (process_ == 0) become(inside.c_str(), argv.data(), files, parent);
}

Child::~Child() {
  if (process_ < 0) return;
  ::kill(process_, SIGKILL);
  ::waitpid(process_, nullptr, 0);
}

bool Child::ended() {
  if (process_ < 0) return true;
  late_ = std::chrono::steady_clock::now() - begin_ > child_time;
  if (late_) ::kill(process_, SIGKILL);
  if (::waitpid(process_, &status_, late_ ? 0 : WNOHANG) != process_) return false;
  process_ = -1;
  return true;
}

std::string Child::failure() const {
  if (status_ == 0) return {};
  const std::string limits = fmt::format("; here it is given {} MB and {} s, modebank report has no such limits",
                                         child_memory_MB, child_time.count());
  if (late_ || (WIFSIGNALED(status_) && WTERMSIG(status_) == SIGXCPU)) return "it took too long" + limits;
  if (WIFSIGNALED(status_))
    return fmt::format("its process was ended by signal {} ({}){}", WTERMSIG(status_), ::strsignal(WTERMSIG(status_)),
                       limits);
  std::string said = beginning_of(folder_ / "err", 2000);
  if (said.find("bad_alloc") != std::string::npos) return "it takes too much memory" + limits;
  while (!said.empty() && said.back() == '\n') said.pop_back();
  constexpr std::string_view prefix = "modebank: ";
  if (said.rfind(prefix, 0) == 0) said.erase(0, prefix.size());
  return said.empty() ? fmt::format("its process ended with status {}", WEXITSTATUS(status_)) : said;
}

std::string beginning_of(const fs::path& path, std::size_t bytes) {
  std::string text(bytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(text.data(), static_cast<std::streamsize>(bytes));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

}  // namespace modebank::app::view
