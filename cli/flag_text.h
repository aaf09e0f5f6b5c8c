#pragma once
/// How the command line shows settings: the key `detail` as the flag --detail.

#include <string>

#include "pellicle/base/errors.h"

namespace pellicle::cli {

/// A text of the libraries in which every key in backquotes has become a flag.
std::string with_flags(const std::string& text);

/// The line of an error.
std::string message_of(const Error& error);

}  // namespace pellicle::cli
