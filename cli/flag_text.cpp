#include "flag_text.h"

#include <fmt/format.h>

#include <cctype>

#include "pellicle/settings/setting_text.h"

namespace pellicle::cli {

namespace {

// "time-step, mass" -> "--time-step, --mass"; words that are not keys, such as FILE, stay.
std::string flags_of(const std::string& keys) {
  std::string text;
  bool start = true;
  for (const char c : keys) {
    if (start && std::islower(static_cast<unsigned char>(c)) != 0) text += "--";
    text += c;
    start = c == ' ';
  }
  return text;
}

}  // namespace

std::string with_flags(const std::string& text) {
  return with_setting_names(text, "--");
}

std::string message_of(const Error& error) {
  const auto* fault = dynamic_cast<const SettingError*>(&error);
  if (fault == nullptr || !fault->place.empty()) return with_flags(error.what());
  const std::string value = fault->value.empty() ? "" : " " + fault->value;
  return fmt::format("{} ({}{}): {}", with_flags(fault->subject), flags_of(fault->key), value, with_flags(fault->why));
}

}  // namespace pellicle::cli
