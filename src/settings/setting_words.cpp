#include "pellicle/settings/setting_words.h"

#include <charconv>
#include <cmath>

namespace pellicle {

namespace {

template <class Number>
std::optional<Number> whole_in(const std::string& word) {
  Number value = 0;
  const auto [rest, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || rest != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> number_in(const std::string& word) {
  const char* begin = word.data();
  const char* end = begin + word.size();
  if (begin != end && *begin == '+') ++begin;
  double value = 0.0;
  const auto [rest, fault] = std::from_chars(begin, end, value);
  if (fault != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<int> integer_in(const std::string& word) {
  return whole_in<int>(word);
}

std::optional<long long> long_integer_in(const std::string& word) {
  return whole_in<long long>(word);
}

double number_of(const std::string& word, const std::string& where) {
  const auto value = number_in(word);
  if (!value) throw UsageError("bad value (" + where + "): '" + word + "' is not a finite number; write it like 12.5");
  return *value;
}

int integer_of(const std::string& word, const std::string& where) {
  const auto value = integer_in(word);
  if (!value) throw UsageError("bad value (" + where + "): '" + word + "' is not a whole number; write it like 12");
  return *value;
}

std::vector<std::string> split_commas(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else if (c != ' ' && c != '\t') {
      parts.back() += c;
    }
  }
  return parts;
}

std::string joined_by_commas(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

}  // namespace pellicle
