#pragma once
/// Settings of `pellicle segment`: from one volume to masks, meshes, models and a report.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/options.h"
#include "pellicle/fit/plan.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/seed/blob_scale_space.h"
#include "pellicle/settings/setting_table.h"
#include "pellicle/settings/setting_words.h"

namespace pellicle {

/// Frame of the coordinates that a user types: LPS mm, RAS mm, or 0-based voxel indices (radii stay in mm).
enum class Coords { lps, ras, ijk };
enum class Objects { one, many };
/// Where expert points pull: the surface along its normal only (they may slide), or the nearest place as a whole.
enum class PointsPull { normal, point };

struct SegmentSettings {
  std::filesystem::path input, output;
  std::string name;                                 ///< file stem; empty: the input's name without its extensions
  std::vector<std::array<double, 4>> seed_spheres;  ///< x, y, z in `coords`, radius in mm
  std::vector<std::array<double, 3>> seed_points;   ///< x, y, z in `coords`: spheres of `seed_radius`
  double seed_radius = 5.0;                         ///< of `seed_points`, mm
  std::optional<std::filesystem::path> seeds_file;  ///< CSV: x,y,z,r[,label[,name]], in `coords`
  std::optional<std::string> seed_mask;             ///< FILE[:LABEL]
  std::optional<std::filesystem::path> seed_model;
  bool seed_auto = false;  ///< also what happens when no seed is given
  Objects objects = Objects::one;
  std::optional<RadiusRange> radius;  ///< of many objects, mm; default: estimated
  double valley = 0.9;                ///< of many objects: SeedRules::valley
  Coords coords = Coords::lps;
  std::optional<Vec3> spacing;                  ///< mm, instead of the file's
  std::string preset;                           ///< its name or file; its values are already in the other fields
  std::optional<std::filesystem::path> points;  ///< expert points, in `coords`
  PointsPull points_pull = PointsPull::normal;
  std::optional<std::filesystem::path> trace;  ///< folder for the meshes on the way
  int trace_every = 3;                         ///< steps
  FitOptions fit;
  std::optional<ModelKind> model;  ///< as named by the user; default: see model_kind()
  std::vector<std::string> write{"mask", "mesh", "model", "report"};
  MeshFormat mesh_format = MeshFormat::ply;
  std::optional<int> mesh_density;  ///< 2^N facets along a control edge; default: half the mean spacing
  std::optional<std::filesystem::path> output_mask, output_mesh;  ///< these files, wherever; `output` may be empty then
  int threads = 0;                                                ///< 0: all
  bool overwrite = false;

  /// Whether this kind of output is written to the output folder; none is when there is no folder.
  bool writes(const std::string& kind) const;
  /// `seed_spheres`, then `seed_points`.
  std::vector<std::array<double, 4>> all_seed_spheres() const;
  /// `model` or, for many objects, Catmull-Clark, else the normal model.
  ModelKind model_kind() const;
  /// Whether several objects are asked for, so that a label map is written however many there are.
  bool wants_many() const { return objects == Objects::many; }
  /// \throws SettingError with the key, its value and the rule. Does not look at any file.
  void validate() const;
  /// The same without the need for an input and an output.
  void validate_values() const;
};

/// The plan that runs, by the seeds that are given.
FitPlan plan_of(const SegmentSettings& settings);

/// The stem of the output files: `name`, or the input's file name without the extensions of volume files.
std::string stem_of(const SegmentSettings& settings);

/// All settings in the order of the help. Stages are not among them: see settings_toml.h.
const SettingTable<SegmentSettings>& segment_table();

template <>
const Words<Coords>& words_of();
template <>
const Words<Objects>& words_of();
template <>
const Words<PointsPull>& words_of();
template <>
const Words<Polarity>& words_of();
template <>
const Words<Boundary>& words_of();
template <>
const Words<StartRule>& words_of();
template <>
const Words<Solver>& words_of();
template <>
const Words<SubdivisionRule>& words_of();
template <>
const Words<StartSolid>& words_of();
template <>
const Words<ModelKind>& words_of();
template <>
const Words<MeshFormat>& words_of();

}  // namespace pellicle
