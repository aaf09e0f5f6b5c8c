#pragma once
/// Names of parameterised tests: letters, digits and underscores only.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace pellicle {

inline std::string shape_test_name(const testing::TestParamInfo<std::string>& test) {
  std::string name = test.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace pellicle
