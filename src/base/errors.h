#pragma once
/// Errors of the caller's making or of the outside world. Each type has one exit code (sysexits.h); they are thrown
/// anywhere and caught only in cli/main.cpp, which prints one line: `pellicle: error: WHAT (WHERE): WHY; HINT`.
/// A fit that went wrong is never an exception: it is a status in the summary.

#include <stdexcept>
#include <string>

namespace pellicle {

class Error : public std::runtime_error {
 public:
  Error(int exit_code, const std::string& message) : std::runtime_error(message), exit_code_(exit_code) {}
  int exit_code() const { return exit_code_; }

 private:
  int exit_code_;
};

/// A flag, setting or combination of them that cannot be honoured.
struct UsageError : Error {
  explicit UsageError(const std::string& message) : Error(64, message) {}
};
/// A setting that cannot be honoured. It carries the key of the setting, as the table of settings spells it; a host
/// shows it in its own way (the command line as the flag `--KEY`).
struct SettingError : UsageError {
  /// \param of_what the thing that is wrong: "expert points".
  /// \param its_key "points"; of several: "time-step, mass".
  /// \param reason the rule and the value that breaks it.
  SettingError(const std::string& of_what, const std::string& its_key, const std::string& reason)
      : UsageError(of_what + " (" + its_key + "): " + reason), subject(of_what), key(its_key), why(reason) {}
  std::string subject, key, why;
};
/// An input that exists but is broken, inconsistent or of a kind that is not supported.
struct BadData : Error {
  explicit BadData(const std::string& message) : Error(65, message) {}
};
/// A named input that does not exist or cannot be opened.
struct NoInput : Error {
  explicit NoInput(const std::string& message) : Error(66, message) {}
};
/// An output that may not or cannot be created.
struct CannotCreate : Error {
  explicit CannotCreate(const std::string& message) : Error(73, message) {}
};
/// Reading or writing failed half way (disk full, device error).
struct IoError : Error {
  explicit IoError(const std::string& message) : Error(74, message) {}
};
/// The user stopped the run (SIGINT, SIGTERM).
struct Interrupted : Error {
  Interrupted() : Error(130, "interrupted") {}
};

}  // namespace pellicle
