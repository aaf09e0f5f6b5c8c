#pragma once
/// How a row of a table of settings is declared: its key, and the field that holds its value. What kind of setting it
/// is follows from the type of the field.
///
///     setting<MorphSettings>({"Path", "steps", "N", "shapes, equally spaced"}, SETTING_FIELD(steps))

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "pellicle/base/errors.h"
#include "pellicle/settings/setting_table.h"
#include "pellicle/settings/setting_words.h"

// Reads and writes a field, also one of a struct inside (a pointer to member cannot).
// NOLINTBEGIN(bugprone-macro-parentheses): `member` is a name, not an expression.
#define SETTING_FIELD(member) \
  [](auto& s) -> auto& {      \
    return s.member;          \
  }
// NOLINTEND(bugprone-macro-parentheses)

namespace pellicle {

[[noreturn]] inline void refuse_setting(const std::string& key, const std::string& value, const std::string& why) {
  throw SettingError("bad value", key, value, why);
}
[[noreturn]] inline void refuse_setting(const SettingKey& key, const SettingValues& values, const std::string& why) {
  refuse_setting(key.name, joined_by_commas(values), why);
}

/// A value of type T as words and back. `read` \throws SettingError.
template <class T>
struct SettingValue;

template <>
struct SettingValue<bool> {
  static constexpr SettingKind kind = SettingKind::flag;
  static bool read(const SettingKey& key, const SettingValues& v) {
    if (v.at(0) != "true" && v.at(0) != "false") {
      refuse_setting(key, v, fmt::format("'{}' is not a choice; use true or false", v.at(0)));
    }
    return v.at(0) == "true";
  }
  static SettingValues words(bool value) { return {value ? "true" : "false"}; }
};

template <>
struct SettingValue<double> {
  static constexpr SettingKind kind = SettingKind::number;
  static double read(const SettingKey& key, const SettingValues& v) {
    const auto value = number_in(v.at(0));
    if (!value) refuse_setting(key, v, fmt::format("'{}' is not a finite number; write it like 12.5", v.at(0)));
    return *value;
  }
  static SettingValues words(double value) { return {fmt::format("{}", value)}; }
};

template <class T>
requires std::is_integral_v<T>
struct SettingValue<T> {
  static constexpr SettingKind kind = SettingKind::number;
  static T read(const SettingKey& key, const SettingValues& v) {
    std::optional<T> value;
    if constexpr (std::is_same_v<T, int>) {
      value = integer_in(v.at(0));
    } else if (const auto number = long_integer_in(v.at(0))) {
      value = static_cast<T>(*number);
    }
    if (!value) refuse_setting(key, v, fmt::format("'{}' is not a whole number; write it like 12", v.at(0)));
    return *value;
  }
  static SettingValues words(T value) { return {fmt::format("{}", static_cast<std::make_signed_t<T>>(value))}; }
};

template <class T>
requires std::is_enum_v<T>
struct SettingValue<T> {
  static constexpr SettingKind kind = SettingKind::text;
  static T read(const SettingKey& key, const SettingValues& v) {
    const auto value = value_in<T>(v.at(0));
    if (!value) {
      refuse_setting(key, v, fmt::format("'{}' is not a choice; use one of {}", v.at(0), list_of_words<T>()));
    }
    return *value;
  }
  static SettingValues words(T value) { return {name_of(value)}; }
};

/// An empty text is a text that is not set.
template <>
struct SettingValue<std::string> {
  static constexpr SettingKind kind = SettingKind::text;
  static std::string read(const SettingKey& /*key*/, const SettingValues& v) { return v.at(0); }
  static SettingValues words(const std::string& value) {
    return value.empty() ? SettingValues{} : SettingValues{value};
  }
};

template <>
struct SettingValue<std::filesystem::path> {
  static constexpr SettingKind kind = SettingKind::text;
  static std::filesystem::path read(const SettingKey& /*key*/, const SettingValues& v) { return v.at(0); }
  static SettingValues words(const std::filesystem::path& value) {
    return value.empty() ? SettingValues{} : SettingValues{value.string()};
  }
};

template <>
struct SettingValue<std::vector<std::string>> {
  static constexpr SettingKind kind = SettingKind::words;
  static std::vector<std::string> read(const SettingKey& /*key*/, const SettingValues& v) { return v; }
  static SettingValues words(const std::vector<std::string>& value) { return value; }
};

/// A list of numbers of any length.
template <class Number>
requires std::is_arithmetic_v<Number>
struct SettingValue<std::vector<Number>> {
  static constexpr SettingKind kind = SettingKind::vector;
  static std::vector<Number> read(const SettingKey& key, const SettingValues& v) {
    std::vector<Number> numbers;
    for (const auto& word : v) {
      if constexpr (std::is_same_v<Number, int>) {
        const auto number = integer_in(word);
        if (!number) refuse_setting(key, v, fmt::format("'{}' is not a whole number; write it like 12", word));
        numbers.push_back(*number);
      } else {
        const auto number = number_in(word);
        if (!number) refuse_setting(key, v, fmt::format("'{}' is not a finite number; write it like 12.5", word));
        numbers.push_back(*number);
      }
    }
    return numbers;
  }
  static SettingValues words(const std::vector<Number>& value) {
    SettingValues words;
    for (const Number number : value) words.push_back(fmt::format("{}", number));
    return words;
  }
};

/// N numbers; where `one_for_all`, a single one stands for all of them.
template <class Number>
std::vector<Number> numbers_of(const SettingKey& key, const SettingValues& v, std::size_t count,
                               bool one_for_all = false) {
  std::vector<Number> numbers = SettingValue<std::vector<Number>>::read(key, v);
  if (one_for_all && numbers.size() == 1) numbers.resize(count, numbers[0]);
  if (numbers.size() != count) {
    const char* whole = std::is_same_v<Number, int> ? "whole " : "";
    refuse_setting(key, v,
                   fmt::format("{} {}numbers are needed, separated by commas, not {}", count, whole, numbers.size()));
  }
  return numbers;
}

template <class Number, std::size_t N>
struct SettingValue<std::array<Number, N>> {
  static constexpr SettingKind kind = SettingKind::vector;
  static std::array<Number, N> read(const SettingKey& key, const SettingValues& v) {
    const auto numbers = numbers_of<Number>(key, v, N);
    std::array<Number, N> value{};
    std::copy(numbers.begin(), numbers.end(), value.begin());
    return value;
  }
  static SettingValues words(const std::array<Number, N>& value) {
    return SettingValue<std::vector<Number>>::words({value.begin(), value.end()});
  }
};

/// Several vectors, a word each: "x,y,z".
template <class Number, std::size_t N>
struct SettingValue<std::vector<std::array<Number, N>>> {
  static constexpr SettingKind kind = SettingKind::vectors;
  static std::vector<std::array<Number, N>> read(const SettingKey& key, const SettingValues& v) {
    std::vector<std::array<Number, N>> vectors;
    for (const auto& word : v) vectors.push_back(SettingValue<std::array<Number, N>>::read(key, split_commas(word)));
    return vectors;
  }
  static SettingValues words(const std::vector<std::array<Number, N>>& value) {
    SettingValues words;
    for (const auto& vector : value) {
      words.push_back(joined_by_commas(SettingValue<std::array<Number, N>>::words(vector)));
    }
    return words;
  }
};

/// Not set, or a value.
template <class T>
struct SettingValue<std::optional<T>> {
  static constexpr SettingKind kind = SettingValue<T>::kind;
  static std::optional<T> read(const SettingKey& key, const SettingValues& v) { return SettingValue<T>::read(key, v); }
  static SettingValues words(const std::optional<T>& value) {
    return value ? SettingValue<T>::words(*value) : SettingValues{};
  }
};

template <class T>
constexpr bool is_whole = std::is_integral_v<T> && !std::is_same_v<T, bool>;
template <class T>
constexpr bool is_whole<std::optional<T>> = is_whole<T>;

/// A row whose value is a field of S. \param field SETTING_FIELD(member).
template <class S, class F>
Setting<S> setting(const SettingKey& key, F field) {
  using T = std::decay_t<decltype(field(std::declval<S&>()))>;
  Setting<S> row{key, {}, {}};
  if (key.kind != SettingKind::several) row.kind = SettingValue<T>::kind;
  row.whole = is_whole<T>;
  // Copies the key: rows move while the table is made.
  row.set = [field, plain = static_cast<const SettingKey&>(row)](S& s, const SettingValues& values) {
    field(s) = SettingValue<T>::read(plain, values);
  };
  row.get = [field](const S& s) { return SettingValue<T>::words(field(s)); };
  return row;
}

/// A row whose value is more than a field. \param set (S&, const SettingKey&, const SettingValues&).
template <class S, class Set, class Get>
Setting<S> setting(const SettingKey& key, SettingKind kind, Set set, Get get) {
  Setting<S> row{key, {}, get};
  row.kind = kind;
  row.set = [set, plain = static_cast<const SettingKey&>(row)](S& s, const SettingValues& values) {
    set(s, plain, values);
  };
  return row;
}

}  // namespace pellicle
