#pragma once
/// Where a result came from and what it cost.

#include <string>
#include <utility>
#include <vector>

namespace pellicle {

/// Program and library versions, by name.
std::string program_version();
std::vector<std::pair<std::string, std::string>> library_versions();

/// Largest resident size of the process so far, bytes.
long peak_memory_bytes();
/// Now, UTC, "2026-01-31T12:34:56Z".
std::string utc_time();

}  // namespace pellicle
