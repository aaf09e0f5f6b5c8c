#pragma once
/// Exit codes of every subcommand (the numbers of sysexits.h).

#include "pellicle/base/errors.h"

namespace pellicle::cli {

constexpr int kSuccess = 0;
constexpr int kFailure = 1;
constexpr int kUsage = 64;

/// Code 3 (it ran, but an object failed its own checks) is not an error: the results of the jobs carry it.
constexpr int exit_code_of(ErrorCategory category) {
  switch (category) {
    case ErrorCategory::failure:
      return kFailure;
    case ErrorCategory::usage:
      return kUsage;
    case ErrorCategory::bad_data:
      return 65;
    case ErrorCategory::no_input:
      return 66;
    case ErrorCategory::cannot_create:
      return 73;
    case ErrorCategory::io:
      return 74;
    case ErrorCategory::interrupted:
      return 130;
  }
  return kFailure;
}

}  // namespace pellicle::cli
