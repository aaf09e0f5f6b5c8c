#include "pellicle/settings/setting_table.h"

#include <sstream>

namespace pellicle {

std::vector<std::string> SettingKey::choices() const {
  std::vector<std::string> words;
  if (kind != SettingKind::text || placeholder.find('|') == std::string::npos) return words;
  std::istringstream all(placeholder);
  for (std::string word; std::getline(all, word, '|');) words.push_back(word);
  return words;
}

}  // namespace pellicle
