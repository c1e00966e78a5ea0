// failing_call K|K+ REPORT FOLDER PROGRAM ARGUMENTS...
//
// Simulates a disk that becomes full, for any library. Runs a program and counts the system calls of it and its
// children that write to FOLDER (and to standard output, if that is a file): create, write, truncate, sync, close after
// writing, rename, link. The K-th call fails with ENOSPC and does nothing; with K+ all later calls fail, too. REPORT
// gets the number of calls, and one line for each failed call. The exit status is the program's. The kernel reports
// each call before it acts (seccomp's user notification), so calls inside the C library count, too.
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

/// A system call, and the argument that names its file.
struct Call {
  int number;
  const char* name;
  enum class On { descriptor, path, path_at } on;
  unsigned argument;
};

using On = Call::On;
constexpr std::array calls{Call{SYS_write, "write", On::descriptor, 0},
                           Call{SYS_pwrite64, "pwrite", On::descriptor, 0},
                           Call{SYS_writev, "writev", On::descriptor, 0},
                           Call{SYS_pwritev, "pwritev", On::descriptor, 0},
                           Call{SYS_fsync, "fsync", On::descriptor, 0},
                           Call{SYS_fdatasync, "fdatasync", On::descriptor, 0},
                           Call{SYS_ftruncate, "ftruncate", On::descriptor, 0},
                           Call{SYS_fallocate, "fallocate", On::descriptor, 0},
                           Call{SYS_close, "close", On::descriptor, 0},
                           Call{SYS_openat, "open", On::path_at, 1},
                           Call{SYS_mkdirat, "mkdir", On::path_at, 1},
                           Call{SYS_renameat2, "rename", On::path_at, 3},
#ifdef SYS_rename
                           Call{SYS_open, "open", On::path, 0},
                           Call{SYS_creat, "open", On::path, 0},
                           Call{SYS_mkdir, "mkdir", On::path, 0},
                           Call{SYS_rename, "rename", On::path, 1},
                           Call{SYS_link, "link", On::path, 1},
                           Call{SYS_symlink, "symlink", On::path, 1},
                           Call{SYS_truncate, "truncate", On::path, 0},
#endif
                           Call{SYS_renameat, "rename", On::path_at, 3}};

[[noreturn]] void fail(const std::string& what) {
  fmt::print(stderr, "failing_call: {}: {}\n", what, std::strerror(errno));
  std::exit(125);
}

/// Makes the kernel report these calls. Returns the descriptor for the reports.
int install_filter() {
  std::vector<sock_filter> program;
  program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)));
  for (const Call& call : calls) {
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(call.number), 0, 1));
    program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF));
  }
  program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  const sock_fprog whole{static_cast<unsigned short>(program.size()), program.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) fail("no_new_privs");
  return static_cast<int>(syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &whole));
}

/// A message of one byte, with room for a descriptor.
struct DescriptorMessage {
  char byte = 0;
  iovec part{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr header{};

  DescriptorMessage() {
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
  }
  DescriptorMessage(const DescriptorMessage&) = delete;  // the header contains pointers into this object
  DescriptorMessage& operator=(const DescriptorMessage&) = delete;
};

void send_descriptor(int socket, int descriptor) {
  DescriptorMessage message;
  cmsghdr* const head = CMSG_FIRSTHDR(&message.header);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof descriptor);
  std::memcpy(CMSG_DATA(head), &descriptor, sizeof descriptor);
  if (sendmsg(socket, &message.header, 0) < 0) fail("sendmsg");
}

int receive_descriptor(int socket) {
  DescriptorMessage message;
  if (recvmsg(socket, &message.header, MSG_CMSG_CLOEXEC) <= 0 || !CMSG_FIRSTHDR(&message.header))
    fail("no seccomp listener");
  int descriptor = -1;
  std::memcpy(&descriptor, CMSG_DATA(CMSG_FIRSTHDR(&message.header)), sizeof descriptor);
  return descriptor;
}

std::string link_target(const std::string& link) {
  std::array<char, 4096> target{};
  const ssize_t count = readlink(link.c_str(), target.data(), target.size());
  return count > 0 ? std::string(target.data(), static_cast<std::size_t>(count)) : std::string();
}

/// The text at an address in another process.
std::string text_at(unsigned pid, std::uint64_t address) {
  std::string text(4096, '\0');
  const int memory = open(fmt::format("/proc/{}/mem", pid).c_str(), O_RDONLY | O_CLOEXEC);
  ssize_t count = -1;
  for (std::size_t room = text.size(); count < 0 && room > 8;
       room /= 2)  // the text may end before its memory page ends
    count = pread(memory, text.data(), room, static_cast<off_t>(address));
  close(memory);
  return text.c_str();
}

/// The file to which the call writes; empty if the file is outside the folder.
class Counted {
 public:
  explicit Counted(std::string folder) : folder_(std::move(folder)) {}

  std::string file_of(const Call& call, const seccomp_notif& asked) const {
    if (call.on == On::descriptor) return of_descriptor(call, asked);
    const bool opens = std::strcmp(call.name, "open") == 0 && call.number != static_cast<int>(SYS_creat);
    if (opens && (asked.data.args[call.argument + 1] & O_CREAT) == 0) return {};
    std::string path = text_at(asked.pid, asked.data.args[call.argument]);
    if (!path.empty() && path.front() != '/') path = link_target(fmt::format("/proc/{}/cwd", asked.pid)) + "/" + path;
    if (!within(path)) return {};
    struct stat about {};
    if (opens && stat(path.c_str(), &about) == 0) return {};  // creates nothing
    return path;
  }

 private:
  bool within(const std::string& path) const { return path.starts_with(folder_ + "/"); }

  std::string of_descriptor(const Call& call, const seccomp_notif& asked) const {
    const auto descriptor = static_cast<int>(asked.data.args[0]);
    const std::string link = fmt::format("/proc/{}/fd/{}", asked.pid, descriptor), path = link_target(link);
    struct stat about {};
    if (stat(link.c_str(), &about) != 0) return {};
    if (descriptor == STDOUT_FILENO && S_ISREG(about.st_mode)) return "standard output";
    if (!within(path)) return {};
    if (std::strcmp(call.name, "close") != 0) return path;
    return S_ISREG(about.st_mode) && written(asked.pid, descriptor) ? path : std::string();
  }

  /// Whether the descriptor is open for writing.
  static bool written(unsigned pid, int descriptor) {
    std::ifstream info(fmt::format("/proc/{}/fdinfo/{}", pid, descriptor));
    for (std::string word; info >> word;)
      if (unsigned flags = 0; word == "flags:" && info >> std::oct >> flags) return (flags & O_ACCMODE) != O_RDONLY;
    return false;
  }

  std::string folder_;
};

/// Answers every report until no process is left. Returns the number of calls.
std::uint64_t answer_all(int listener, std::uint64_t first, std::uint64_t last, const Counted& counted,
                         std::vector<std::string>& failed) {
  std::uint64_t count = 0;
  for (pollfd waiting{listener, POLLIN, 0}; poll(&waiting, 1, -1) >= 0 || errno == EINTR;) {
    if ((waiting.revents & POLLIN) == 0) {
      if ((waiting.revents & POLLHUP) != 0) break;
      continue;
    }
    seccomp_notif asked{};
    if (ioctl(listener, SECCOMP_IOCTL_NOTIF_RECV, &asked) != 0) continue;  // the process has been killed
    seccomp_notif_resp answer{asked.id, 0, 0, SECCOMP_USER_NOTIF_FLAG_CONTINUE};
    for (const Call& call : calls) {
      if (call.number != asked.data.nr) continue;
      const std::string file = counted.file_of(call, asked);
      if (file.empty() || ++count < first || count > last) break;
      failed.push_back(fmt::format("{} {}", call.name, file));
      answer.flags = 0;
      answer.error = -ENOSPC;
      break;
    }
    ioctl(listener, SECCOMP_IOCTL_NOTIF_SEND, &answer);
  }
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) {
    fmt::print(stderr, "failing_call K|K+ REPORT FOLDER PROGRAM ARGUMENTS...\n");
    return 125;
  }
  const std::string which = argv[1];
  const std::uint64_t first = std::strtoull(which.c_str(), nullptr, 10);
  const std::uint64_t last = which.ends_with('+') ? ~std::uint64_t{0} : first;
  std::array<int, 2> pair{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()) != 0) fail("socketpair");
  const pid_t child = fork();
  if (child < 0) fail("fork");
  if (child == 0) {
    const int listener = install_filter();
    if (listener < 0) fail("seccomp");
    send_descriptor(pair[1], listener);
    // Closed by exec, because a call of close() here would be reported.
    fcntl(listener, F_SETFD, FD_CLOEXEC);
    execvp(argv[4], argv + 4);
    fail(argv[4]);
  }
  close(pair[1]);
  const int listener = receive_descriptor(pair[0]);
  std::vector<std::string> failed;
  const std::uint64_t count = answer_all(listener, first, last, Counted(argv[3]), failed);
  int status = 0;
  if (waitpid(child, &status, 0) < 0) fail("waitpid");
  std::ofstream report(argv[2]);
  report << count << '\n';
  for (const std::string& line : failed) report << line << '\n';
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
