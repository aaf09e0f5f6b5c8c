#pragma once
/// Runs the program as a user does.

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "../temporary_folder.h"

namespace pellicle::test {

struct Outcome {
  int exit_code = -1;  ///< 1000 + signal when it was killed
  std::string out, err;
};

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

using Scratch = TemporaryFolder;

/// Starts the program with stdout and stderr in files of `scratch`.
inline pid_t start(const std::vector<std::string>& arguments, const Scratch& scratch) {
  const pid_t child = fork();
  if (child != 0) return child;
  const int out = open(scratch(".stdout").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
  const int err = open(scratch(".stderr").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  std::vector<char*> argv{const_cast<char*>(PELLICLE_PROGRAM)};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  execv(PELLICLE_PROGRAM, argv.data());
  _exit(127);
}

inline Outcome finish(pid_t child, const Scratch& scratch) {
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status), read_text(scratch / ".stdout"),
          read_text(scratch / ".stderr")};
}

inline Outcome run(const std::vector<std::string>& arguments, const Scratch& scratch) {
  return finish(start(arguments, scratch), scratch);
}

inline std::ptrdiff_t line_count(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

}  // namespace pellicle::test
