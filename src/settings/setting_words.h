#pragma once
/// Words and numbers as users type them.

#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pellicle/base/errors.h"

namespace pellicle {

/// Each value of an enumeration with its word: "bright", "ridge", ...
template <class E>
using Words = std::vector<std::pair<E, std::string>>;

/// Specialised for each enumeration that is a setting, beside the settings that use it.
template <class E>
const Words<E>& words_of();

template <class E>
requires std::is_enum_v<E> std::string name_of(E value) {
  for (const auto& [candidate, word] : words_of<E>()) {
    if (candidate == value) return word;
  }
  return "unknown";
}

/// The value that a word stands for; nothing when it is not one of the words.
template <class E>
std::optional<E> value_in(const std::string& word) {
  for (const auto& [value, name] : words_of<E>()) {
    if (name == word) return value;
  }
  return std::nullopt;
}

/// "bright, dark, auto".
template <class E>
std::string list_of_words() {
  std::string list;
  for (const auto& [value, name] : words_of<E>()) list += (list.empty() ? "" : ", ") + name;
  return list;
}

/// The same of a word in a file.
/// \param where is named in the error.
/// \throws UsageError that lists the words.
template <class E>
E value_of(const std::string& word, const std::string& where) {
  const auto value = value_in<E>(word);
  if (value) return *value;
  throw UsageError("bad value (" + where + "): '" + word + "' is not a choice; use one of " + list_of_words<E>());
}

/// One finite number; nothing when the word is not one.
std::optional<double> number_in(const std::string& word);
std::optional<int> integer_in(const std::string& word);
std::optional<long long> long_integer_in(const std::string& word);

/// The same of a cell of a table or the like.
/// \param where is named in the error.
/// \throws UsageError.
double number_of(const std::string& word, const std::string& where);
int integer_of(const std::string& word, const std::string& where);

/// "1,2,3" -> {"1", "2", "3"}; blanks go.
std::vector<std::string> split_commas(const std::string& text);
/// {"1", "2"} -> "1,2".
std::string joined_by_commas(const std::vector<std::string>& words);

}  // namespace pellicle
