#include "pellicle/base/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "pellicle/base/errors.h"

namespace pellicle {

namespace {

std::FILE* nameless_file() {
  std::FILE* file = std::tmpfile();
  if (file == nullptr) throw IoError(fmt::format("no temporary file (child process): {}", std::strerror(errno)));
  fcntl(fileno(file), F_SETFD, FD_CLOEXEC);  // other children have no business with it
  return file;
}

std::string content_of(std::FILE* file) {
  std::string text;
  std::array<char, 4096> buffer{};
  std::rewind(file);
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), file)) > 0;) text.append(buffer.data(), n);
  return text;
}

// In the child, after fork: only calls that are safe there.
[[noreturn]] void become(char* const* argv, pid_t parent, int out, int err) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);  // it was gone before the line above
  // A group of its own: an interrupt from the keyboard reaches the parent only, which decides what each child is sent.
  setpgid(0, 0);
  signal(SIGINT, SIG_DFL);
  signal(SIGTERM, SIG_DFL);
  if (dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0) _exit(127);
  execv(argv[0], argv);
  constexpr std::string_view message = "the program cannot be run\n";
  if (write(STDERR_FILENO, message.data(), message.size()) < 0) _exit(126);
  _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments)
    : out_(nameless_file(), &std::fclose), err_(nameless_file(), &std::fclose) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t parent = getpid();
  const int out = fileno(out_.get()), err = fileno(err_.get());
  id_ = fork();
  if (id_ == 0) become(argv.data(), parent, out, err);
  if (id_ < 0) throw IoError(fmt::format("no new process ({}): {}", program.string(), std::strerror(errno)));
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : out_(std::move(other.out_)), err_(std::move(other.err_)), id_(std::exchange(other.id_, -1)) {}

ChildProcess::~ChildProcess() {
  if (id_ < 0) return;
  kill(id_, SIGKILL);
  while (waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void ChildProcess::ask_to_stop() const {
  if (id_ > 0) kill(id_, SIGTERM);
}

std::optional<ChildExit> ChildProcess::poll() {
  int status = 0;
  rusage usage{};
  const pid_t ended = wait4(id_, &status, WNOHANG, &usage);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return std::nullopt;
  if (ended < 0) throw IoError(fmt::format("lost a process ({}): {}", id_, std::strerror(errno)));
  id_ = -1;
  ChildExit result;
  result.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  result.exit_code = WIFSIGNALED(status) ? 128 + result.signal : WEXITSTATUS(status);
  result.peak_memory_bytes = usage.ru_maxrss * 1024;
  result.out = content_of(out_.get());
  result.err = content_of(err_.get());
  return result;
}

std::filesystem::path this_program() {
  std::error_code fault;
  auto path = std::filesystem::read_symlink("/proc/self/exe", fault);
  if (fault) throw IoError(fmt::format("the program's own file is not known (/proc/self/exe): {}", fault.message()));
  return path;
}

}  // namespace pellicle
