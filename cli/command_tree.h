#pragma once
/// The program describing itself: all of it is made from the tree of commands and flags, so it cannot lag behind.

#include <string>

namespace CLI {
class App;
}

namespace pellicle::cli {

/// A script for bash that completes commands, flags and the words that a flag chooses from; all else are files.
std::string bash_completion(const CLI::App& program);

/// The manual page of a command, or of the program itself when `command` is null (troff, section 1).
std::string manual_page(const CLI::App& program, const CLI::App* command);

}  // namespace pellicle::cli
