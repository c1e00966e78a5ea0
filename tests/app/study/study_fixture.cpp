#include "tests/app/study/study_fixture.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "io/archive/inspect.hpp"

namespace modebank::test {
namespace {

/// Between two looks at a state that a test waits for.
void look_again_soon() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

struct ProcessNow {
  char state = 'X';  ///< as in /proc: T (stopped), Z (ended, not reaped), X (gone), and others
  long ticks = 0;    ///< processor time that it has used
};

ProcessNow now_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text, skipped;
  ProcessNow now;
  if (!std::getline(file, text)) return now;
  std::istringstream fields(text.substr(text.rfind(')') + 1));
  fields >> now.state;
  constexpr int before_the_times = 10;
  for (int i = 0; i < before_the_times; ++i) fields >> skipped;
  long in_user = 0, in_system = 0;
  fields >> in_user >> in_system;
  now.ticks = in_user + in_system;
  return now;
}

/// The process that a claim names; 0 without a claim.
pid_t holder_of(const std::filesystem::path& claim) {
  std::ifstream stream(claim);
  const auto text = nlohmann::json::parse(stream, nullptr, false);  // the claim may end while the file is read
  return text.is_object() ? text.at("process").get<pid_t>() : 0;
}

/// Kills the process that a claim names once it has used the processor for so long, if it still makes this trial.
bool kill_holder(const std::filesystem::path& claim, long busy_ticks) {
  const pid_t process = holder_of(claim);
  if (process == 0) return false;
  const long first = now_of(process).ticks;
  while (now_of(process).ticks < first + busy_ticks && holder_of(claim) == process) look_again_soon();
  if (kill(process, SIGSTOP) != 0) return false;
  char state = now_of(process).state;
  for (; state != 'T' && state != 'Z' && state != 'X'; state = now_of(process).state) look_again_soon();
  const bool at_work = state == 'T' && holder_of(claim) == process &&
                       !std::filesystem::exists(std::filesystem::path(claim).replace_extension(".h5"));
  kill(process, at_work ? SIGKILL : SIGCONT);
  return at_work;
}

}  // namespace

StudyTest::StudyTest() {
  write("study.ini", std::string(config_text()) +
                         "[bank]\n"
                         "transition = stay\n"
                         "[study]\n"
                         "vary = window.length = 10 | 20\n"
                         "vary = mixture.components = {1..3}\n"
                         "vary = bank.stay = 0.9 | 0.95\n"
                         "vary = filter.variant = imm | salvi2025\n");
}

std::vector<std::string> StudyTest::study_line(const std::string& folder,
                                               const std::vector<std::string>& options) const {
  std::vector<std::string> line{MODEBANK_PROGRAM,  "study",          file("study.ini").string(), "--data.root",
                                file("").string(), "--study.output", file(folder).string()};
  line.insert(line.end(), options.begin(), options.end());
  return line;
}

ProgramResult StudyTest::study(const std::string& folder, const std::vector<std::string>& options) const {
  return run_program(study_line(folder, options));
}

std::string StudyTest::numbers(const std::string& folder) const {
  const std::filesystem::path path = file(folder) / "study.h5";
  return inspect(path, "/study").dump() + inspect(path, "/answers/main_effects").dump() +
         inspect(path, "/answers/best").dump();
}

std::set<std::filesystem::path> StudyTest::files(const std::string& folder) const {
  std::set<std::filesystem::path> paths;
  for (const auto& part : {file(folder), file(folder) / "trials", file(folder) / "cache"}) {
    std::error_code absent;
    for (std::filesystem::directory_iterator at(part, absent), end; !absent && at != end; at.increment(absent))
      paths.insert(at->path());
  }
  return paths;
}

std::vector<std::filesystem::path> StudyTest::trial_files(const std::string& folder, const char* extension) const {
  std::vector<std::filesystem::path> paths;
  for (const auto& path : files(folder))
    if (path.extension() == extension && path.parent_path().filename() == "trials") paths.push_back(path);
  return paths;
}

void StudyTest::wait_for_changes(const std::string& folder, unsigned changes, const Process& process) const {
  std::set<std::filesystem::path> before = files(folder);
  while (changes > 0 && process.running()) {
    std::set<std::filesystem::path> now = files(folder);
    if (now != before) --changes;
    before = std::move(now);
    look_again_soon();
  }
}

bool StudyTest::kill_a_worker(const std::string& folder, std::mt19937_64& generator, long busy_ticks) const {
  std::vector<std::filesystem::path> claims = trial_files(folder, ".claim");
  std::shuffle(claims.begin(), claims.end(), generator);
  return std::any_of(claims.begin(), claims.end(), [&](const auto& claim) { return kill_holder(claim, busy_ticks); });
}

void StudyTest::run_undisturbed() const {
  const ProgramResult result = study(undisturbed);
  ASSERT_EQ(result.status, 0) << result.err;
  ASSERT_EQ(archives(undisturbed).size(), trials);
}

Process::Process(const std::vector<std::string>& arguments) : child_(fork()) {
  if (child_ < 0) throw std::runtime_error("fork failed");
  if (child_ > 0) {
    setpgid(child_, child_);  // the child does this as well, because either process may be first
    return;
  }
  setpgid(0, 0);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  execv(argv[0], argv.data());
  _exit(127);
}

Process::~Process() {
  kill_with_children();
  if (!ended_) waitpid(child_, nullptr, 0);
}

void Process::kill_alone() const {
  if (!ended_) kill(child_, SIGKILL);
}

void Process::kill_with_children() const { killpg(child_, SIGKILL); }

bool Process::running() const {
  siginfo_t ended{};
  return !ended_ && waitid(P_PID, static_cast<id_t>(child_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         ended.si_pid == 0;
}

int Process::wait() {
  int status = 0;
  if (waitpid(child_, &status, 0) < 0) throw std::runtime_error("waitpid failed");
  ended_ = true;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace modebank::test
