#include "pellicle/output/preset_by_image.h"

#include <algorithm>

#include "pellicle/base/errors.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/output/seed_files.h"

namespace pellicle {

namespace {

std::size_t seeded_objects(const SegmentSettings& settings) {
  std::size_t count = settings.all_seed_spheres().size();
  if (settings.seeds_file) count += read_seed_table(*settings.seeds_file).size();
  if (settings.seed_mask || settings.seed_model || settings.points) count = std::max<std::size_t>(1, count);
  return count;
}

}  // namespace

PresetChoice choose_preset_for(const SegmentSettings& typed) {
  if (typed.input.empty()) {
    throw SettingError("missing setting", "input", "`preset` auto looks at the input volume; give `input` VOLUME");
  }
  check_seed_files(typed);
  const Volume volume = read_volume(typed.input, {typed.spacing, 0});
  return choose_preset(list_presets(), image_facts(volume.image, seeded_objects(typed), volume.header.spacing_known));
}

}  // namespace pellicle
