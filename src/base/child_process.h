#pragma once
/// Other programs as children of this one, several at a time.

#include <sys/types.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pellicle {

/// How a child ended.
struct ChildExit {
  int exit_code = 0;           ///< 128 + signal when a signal ended it, as in shells
  int signal = 0;              ///< 0: it ended by itself
  long peak_memory_bytes = 0;  ///< largest resident size
  std::string out, err;        ///< all that it wrote on stdout and stderr
};

/// A running child; its output is collected in files without names. It dies with its parent, and with this object.
class ChildProcess {
 public:
  /// \pre no other thread runs.
  /// \throws IoError when a process cannot be made. A program that cannot be run exits with 127.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Does not wait: none while it still runs.
  /// \pre it has not yet returned an exit.
  std::optional<ChildExit> poll();
  /// Asks it to stop (SIGTERM).
  void ask_to_stop() const;

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  File out_, err_;
  pid_t id_ = -1;  ///< -1: ended
};

/// The file of the program that runs now.
/// \throws IoError.
std::filesystem::path this_program();

}  // namespace pellicle
