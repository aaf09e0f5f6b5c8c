#pragma once
/// Errors of the user's making or of the outside world, one type a category. They are thrown anywhere and caught only
/// by the program around the libraries, which prints one line `WHAT (WHERE): WHY; HINT` (cli/main.cpp) and gives each
/// category its exit code (cli/exit_codes.h). A fit that went wrong is never an exception: it is a status in the
/// summary.
///
/// A message names a setting by its key in backquotes, "give `overwrite`": each program shows it in its own way (the
/// command line as a flag).

#include <stdexcept>
#include <string>

namespace pellicle {

enum class ErrorCategory {
  failure,        ///< none of the others
  usage,          ///< a setting, or a combination of settings, that cannot be honoured
  bad_data,       ///< an input that is broken, inconsistent or of a kind that is not supported
  no_input,       ///< an input that does not exist or cannot be opened
  cannot_create,  ///< an output that may not or cannot be created
  io,             ///< reading or writing failed half way: disk full, device error
  interrupted,    ///< the user stopped the run (SIGINT, SIGTERM)
};

class Error : public std::runtime_error {
 public:
  Error(ErrorCategory category, const std::string& message) : std::runtime_error(message), category_(category) {}
  ErrorCategory category() const { return category_; }

 private:
  ErrorCategory category_;
};

struct Failure : Error {
  explicit Failure(const std::string& message) : Error(ErrorCategory::failure, message) {}
};
struct UsageError : Error {
  explicit UsageError(const std::string& message) : Error(ErrorCategory::usage, message) {}
};
struct BadData : Error {
  explicit BadData(const std::string& message) : Error(ErrorCategory::bad_data, message) {}
};
struct NoInput : Error {
  explicit NoInput(const std::string& message) : Error(ErrorCategory::no_input, message) {}
};
struct CannotCreate : Error {
  explicit CannotCreate(const std::string& message) : Error(ErrorCategory::cannot_create, message) {}
};
struct IoError : Error {
  explicit IoError(const std::string& message) : Error(ErrorCategory::io, message) {}
};
struct Interrupted : Error {
  Interrupted() : Error(ErrorCategory::interrupted, "interrupted") {}
};

/// A setting that cannot be honoured. It carries the key of the setting, as the table of settings spells it.
struct SettingError : UsageError {
  /// \param fault what is wrong: "conflicting settings".
  /// \param setting the key: "detail"; several: "time-step, mass".
  /// \param reason the rule, and what to do.
  SettingError(const std::string& fault, const std::string& setting, const std::string& reason)
      : SettingError(fault, setting, "", reason) {}
  /// \param given the value as it was given: "-3".
  SettingError(const std::string& fault, const std::string& setting, const std::string& given,
               const std::string& reason)
      : SettingError(fault, setting, given, "", reason) {}

  /// The same fault of a value that stands in a file.
  /// \param where the place: "run.toml:3, detail". It is shown instead of key and value.
  SettingError at(const std::string& where) const { return {subject, key, value, where, why}; }

  std::string subject, key, value, place, why;

 private:
  SettingError(const std::string& fault, const std::string& setting, const std::string& given, const std::string& where,
               const std::string& reason)
      : UsageError(fault + " (" + (where.empty() ? setting + (given.empty() ? "" : " " + given) : where) +
                   "): " + reason),
        subject(fault),
        key(setting),
        value(given),
        place(where),
        why(reason) {}
};

}  // namespace pellicle
