#pragma once
/// The preset `auto` for a volume that is still a file.

#include "pellicle/settings/preset_choice.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

/// Reads the volume and chooses by its facts.
/// \param typed settings as far as they are known without a preset: input, spacing and seeds.
/// \throws UsageError without an input; as read_volume and check_seed_files.
PresetChoice choose_preset_for(const SegmentSettings& typed);

}  // namespace pellicle
