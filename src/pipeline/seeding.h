#pragma once
/// From what the user says about seeds to start surfaces in LPS mm, one entry an object.

#include <string>
#include <vector>

#include "pellicle/image/files/volume_file.h"
#include "pellicle/seed/seed.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

/// A position typed in the frame `coords`, in LPS mm.
Vec3 world_from_coords(const Vec3& x, Coords coords, const ImageGrid& grid);

/// One object to fit and the candidates for its start.
struct ObjectSeed {
  int label = 1;     ///< 1..65535, unique
  std::string name;  ///< "object-1" unless the user named it
  std::vector<Seed> candidates;
};

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

/// The file of --points in LPS mm. \throws NoInput, BadData (no point in the volume, file contents).
ExpertPoints read_expert_points(const SegmentSettings& settings, const ImageGrid& grid);

/// Where a fit to points may start when they say where the object is all around (ellipsoid_of): the solid that they
/// outline (seed/point_outline.h), as a surface; the ball about them where they outline none. None where they do not.
std::optional<Seed> seed_of_points(const ExpertPoints& points, const ImageGrid& grid, const FitOptions& fit);

/// Existence of every file that the seeds and --points name. \throws NoInput.
void check_seed_files(const SegmentSettings& settings);

/// Empty for many objects that the user gave no seeds for. \throws NoInput, BadData (file contents), UsageError (a
/// sphere outside the volume, labels given twice).
/// \param points the expert points of the settings, as read.
std::vector<ObjectSeed> make_seeds(const SegmentSettings& settings, const ExpertPoints& points, const ImageGrid& grid,
                                   const Image<float>& image);

}  // namespace pellicle
