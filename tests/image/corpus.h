#pragma once
/// The tables of odd and broken files: where they are and what must come of each.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "../temporary_folder.h"

namespace pellicle::test {

struct Expectation {
  std::string file;
  int exit_code = 0;
  std::string text;  ///< in the error, or in one warning; empty: no warning
};

inline std::filesystem::path corpus_folder() {
  return std::filesystem::path(PELLICLE_SOURCE_DIR) / "tests/corpus";
}

/// Volumes that a newcomer does not have: tests that need them skip.
inline std::filesystem::path shared_folder() {
  const char* named = std::getenv("PELLICLE_SHARED");
  return named != nullptr ? std::filesystem::path(named) : std::filesystem::path(PELLICLE_SOURCE_DIR) / "../shared";
}

inline std::vector<Expectation> read_table(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  std::vector<Expectation> table;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    const auto first = line.find(','), second = line.find(',', first + 1);
    table.push_back(
        {line.substr(0, first), std::stoi(line.substr(first + 1, second - first - 1)), line.substr(second + 1)});
  }
  if (table.empty()) throw std::runtime_error("no expectation in " + csv.string());
  return table;
}

}  // namespace pellicle::test
