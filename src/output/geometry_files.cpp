#include "pellicle/output/geometry_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "pellicle/base/errors.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/mesh/files/point_file.h"
#include "pellicle/output/seed_files.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

bool is_mesh_file(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<const char*, 6> known{".ply", ".stl", ".obj", ".off", ".vtp", ".gii"};
  return std::find(known.begin(), known.end(), extension) != known.end();
}

/// \param text the argument as it was given, for messages.
Image<std::uint8_t> read_mask(const std::string& text, const MaskArgument& argument) {
  const LabelVolume volume = read_labels(argument.file);
  Image<std::uint8_t> mask(volume.labels.grid);
  bool any = false;
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
    const std::int32_t v = volume.labels.voxels[i];
    mask.voxels[i] = (argument.label ? v == *argument.label : v != 0) ? 1 : 0;
    any = any || mask.voxels[i] != 0;
  }
  if (!any) {
    throw BadData(argument.label ? fmt::format("empty mask ({}): label {} has no voxel", text, *argument.label)
                                 : fmt::format("empty mask ({}): every voxel is 0", text));
  }
  return mask;
}

}  // namespace

GeometryInput read_geometry(const std::string& argument, bool open) {
  const MaskArgument mask = parse_mask_argument(argument);
  std::error_code ignored;
  if (!fs::exists(mask.file, ignored)) {
    throw NoInput(fmt::format("no such file (`input` {}): nothing is there; check the path", mask.file.string()));
  }
  const bool points = !fs::is_directory(mask.file, ignored) && is_point_file(mask.file);
  const bool mesh = !points && is_mesh_file(mask.file);
  if ((points || mesh) && mask.label) {
    throw SettingError("bad value", "input", argument,
                       fmt::format("only a label map has labels; leave ':{}' away", *mask.label));
  }
  if (open && !points && !mesh) {
    throw SettingError("bad value", "open, input", argument, "a mask is closed; leave `open` out");
  }
  const std::string name = mask.file.string();
  if (points) return geometry_of_points(read_points(mask.file), name, open);
  if (mesh) return geometry_of_mesh(read_mesh(mask.file), name, open);
  return geometry_of_mask(read_mask(argument, mask), name);
}

}  // namespace pellicle
