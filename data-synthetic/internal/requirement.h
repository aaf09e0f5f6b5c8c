#pragma once
/// Settings of phantoms are checked one by one.

#include <string>

#include "pellicle/base/errors.h"

namespace pellicle {

/// \throws SettingError unless `ok`, with the key of the setting, its value and the rule that it breaks.
inline void require(bool ok, const char* key, const std::string& value, const char* rule) {
  if (!ok) throw SettingError("bad phantom setting", key, value, rule);
}

}  // namespace pellicle
