#include "pellicle/settings/setting_text.h"

#include <cctype>

namespace pellicle {

namespace {

bool is_key(const std::string& word) {
  if (word.empty() || std::islower(static_cast<unsigned char>(word.front())) == 0) return false;
  for (const char c : word) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::islower(letter) == 0 && std::isdigit(letter) == 0 && c != '-' && c != '*') return false;
  }
  return true;
}

}  // namespace

std::string with_setting_names(const std::string& text, const std::string& prefix) {
  std::string out;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = text.find('`', at);
    const std::size_t close = open == std::string::npos ? open : text.find('`', open + 1);
    if (close == std::string::npos) break;
    const std::string word = text.substr(open + 1, close - open - 1);
    out += text.substr(at, open - at);
    if (is_key(word)) {
      out += prefix + word;
      at = close + 1;
    } else {
      out += '`';
      at = open + 1;
    }
  }
  return out + text.substr(at);
}

}  // namespace pellicle
