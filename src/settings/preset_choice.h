#pragma once
/// The preset `auto`: of the presets whose conditions the facts of an image meet, the one that asks for most.

#include <string>
#include <vector>

#include "pellicle/seed/image_facts.h"
#include "pellicle/settings/presets.h"

namespace pellicle {

/// What was chosen and why.
struct PresetChoice {
  std::string name;  ///< empty: none applies, the defaults do
  std::string reason;
  Facts facts;
};

/// A preset applies when all facts of one of its [[when]] tables lie in their ranges. Of several the table with most
/// conditions wins, of equal ones the first by name.
/// \throws UsageError for a condition on a fact that does not exist.
PresetChoice choose_preset(const std::vector<Preset>& presets, const Facts& facts);

}  // namespace pellicle
