#pragma once
/// Settings of phantoms are checked one by one.

#include <fmt/format.h>

#include <string>

#include "pellicle/base/errors.h"

namespace pellicle {

/// UsageError that names the flag, its value and the rule it breaks, unless `ok`.
inline void require(bool ok, const char* flag, const std::string& value, const char* rule) {
  if (!ok) throw UsageError(fmt::format("bad phantom setting ({} {}): {}", flag, value, rule));
}

}  // namespace pellicle
