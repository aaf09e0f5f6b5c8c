#pragma once
/// Seeds as the settings and their files give them: from text and files to values in LPS mm.

#include <string>
#include <vector>

#include "pellicle/image/files/volume_file.h"
#include "pellicle/job/object_seed.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

/// A position typed in the frame `coords`, in LPS mm.
Vec3 world_from_coords(const Vec3& x, Coords coords, const ImageGrid& grid);

/// A FILE[:LABEL] argument taken apart: the whole text is the file when a file of that name exists.
struct MaskArgument {
  std::filesystem::path file;
  std::optional<int> label;
};
MaskArgument parse_mask_argument(const std::string& argument);

/// Rows of a seeds file. \throws NoInput, BadData naming file and line.
struct SeedRow {
  Vec3 position;
  double radius = 0.0;
  std::optional<int> label;
  std::string name;
};
std::vector<SeedRow> read_seed_table(const std::filesystem::path& path);

/// The expert points that the settings name, in LPS mm.
/// \throws NoInput, BadData (no point in the volume, file contents).
ExpertPoints read_expert_points(const SegmentSettings& settings, const ImageGrid& grid);

/// Looks for every file that the settings name for seeds and points.
/// \throws NoInput.
void check_seed_files(const SegmentSettings& settings);

/// \param grid of the input file, for coordinates that are voxel indices.
/// \param image the same voxels in LPS order.
/// \return one entry an object, with the expert points of settings.fit; none for many objects that are looked for.
/// \throws NoInput, BadData (file contents), UsageError (a sphere outside the volume, labels given twice).
std::vector<ObjectSeed> read_seeds(const SegmentSettings& settings, const ImageGrid& grid, const Image<float>& image);

}  // namespace pellicle
