#pragma once
/// One object that is to be segmented, and where its fit may start.

#include <string>
#include <vector>

#include "pellicle/fit/options.h"
#include "pellicle/seed/seed.h"

namespace pellicle {

struct ObjectSeed {
  int label = 1;                      ///< 1..65535, another one for each object
  std::string name = {};              ///< "object-1" unless it is named
  std::vector<Seed> candidates = {};  ///< one start or several, of which the fit takes the best; LPS mm
  ExpertPoints points = {};           ///< points that the surface should pass through, if any
};

}  // namespace pellicle
