#pragma once
/// Texts that name settings: help and messages spell a key in backquotes, "radius of every `seed-point`", because a
/// library does not know how a program shows its settings.

#include <string>

namespace pellicle {

/// \param prefix stands before each key instead of its backquotes: two dashes make a flag of it.
std::string with_setting_names(const std::string& text, const std::string& prefix);

}  // namespace pellicle
