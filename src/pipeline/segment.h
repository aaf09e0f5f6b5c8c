#pragma once
/// The main job: one volume from settings to files.

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pellicle/fit/fit.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/pipeline/preset_choice.h"
#include "pellicle/pipeline/seeding.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

/// How a run talks to the outside while it goes on. All may be empty.
struct RunContext {
  std::vector<std::string> command_line;  ///< for the report
  Progress progress;
  std::function<void(const std::string&)> inform, warn;
  std::vector<SettingEntry> host_settings = {};    ///< of the program around, for the report
  std::optional<PresetChoice> chosen_preset = {};  ///< with `preset` auto, for the report
};

/// What is told of each of many objects beside what is told of one.
struct ObjectShape {
  Vec3 centre{0, 0, 0};     ///< centroid of the solid, LPS mm
  double sphericity = 0.0;  ///< area of the ball of equal volume over the area; 1 for a ball
  double elongation = 0.0;  ///< longest over shortest axis of the ellipsoid of inertia
  double visible = 1.0;     ///< share of the surface that lies in the image
  double support = 0.0;     ///< fall of the intensity across the surface over the contrast, 0..1
  double limited = 0.0;     ///< share of the visible surface at a neighbour's territory
};

/// How many objects were looked for.
struct ManySummary {
  double radius_mm = 0.0;  ///< typical, as estimated or given; 0: nothing found
  bool dark = false;
  std::size_t seeds = 0, weak = 0, doubled = 0;  ///< places tried; turned down; parts of another object
  double variation = 1.0;                        ///< how uneven the objects are inside (docs/nuclei.md)
  bool typical_shape = false;                    ///< fitted towards their own typical shape
  double z_extent = 0.0;                         ///< mean extent along z over that in x and y, of whole objects
};

/// One fitted object and what was measured on it.
struct ObjectResult {
  int label = 1;
  std::string name;
  Surface surface;
  FitSummary fit = {};
  std::vector<TraceFrame> trace = {};  ///< when `trace` asks for it
  TriangleMesh mesh = {};              ///< as written: closed, outward, LPS mm
  int mesh_level = 0;
  MeshTopology topology = {};
  std::size_t self_intersections = 0;
  double volume_surface_ml = 0.0;  ///< of the smooth surface
  double volume_mask_ml = 0.0;     ///< of the marked voxels
  std::optional<double> volume_openvdb_ml =
      {};                                     ///< of OpenVDB's own mask, inside the image; none where it was not asked
  std::optional<double> volume_mesh_ml = {};  ///< of the written mesh's facets, what lies outside the image included
  double volume_partial_ml = 0.0;             ///< of the partial-volume map, inside the image
  double area_mm2 = 0.0;
  bool touches_border = false;     ///< marked voxels on the border of the volume
  std::size_t overlap_voxels = 0;  ///< voxels that other objects claim too
  double seconds = 0.0;
  std::optional<ObjectShape> shape = {};  ///< of many objects
};

/// Volume and area from `fine`, topology and self-intersections from the object's mesh; a surface that cuts itself is
/// no longer ok but folded. \pre fine has normals.
void measure_surface(const TriangleMesh& fine, ObjectResult& object);

struct OutputFile {
  std::string kind;  ///< "mask", "mesh", ...
  std::filesystem::path path;
  std::string sha256;
  std::uintmax_t bytes = 0;
};

struct InputFile {
  std::string role;  ///< "volume", "seeds", "seed-mask", "seed-model", "points"
  std::filesystem::path path;
  std::string sha256;
};

struct SegmentResult {
  SegmentSettings settings;
  VolumeHeader header;
  std::size_t nan_count = 0, inf_count = 0;
  float min = 0.0F, max = 0.0F;
  std::vector<ObjectResult> objects;
  std::optional<ManySummary> many;  ///< with `objects` many
  std::optional<int> frame;         ///< of a time series, from 0
  std::vector<InputFile> inputs;
  std::vector<OutputFile> outputs;                      ///< all but the report itself
  std::vector<std::pair<std::string, double>> seconds;  ///< per phase
  std::vector<std::string> warnings;
  bool writes_labels() const;  ///< a label map, not a mask
  /// 0, or 3 when an object failed its own checks.
  int exit_code() const;
};

/// Reads, seeds, fits, measures and writes. Nothing is written before every object is fitted.
/// \throws what settings.validate(), read_volume, make_seeds and the writers throw; CannotCreate when an output exists
///         and settings.overwrite is false (before any work); Interrupted.
SegmentResult segment(const SegmentSettings& settings, const RunContext& context);

/// Where one frame of a time series begins.
struct FrameStart {
  std::optional<int> frame = {};       ///< of a 4D input; none: the input is 3D
  std::vector<ObjectSeed> seeds = {};  ///< instead of what the settings say, unless empty
  /// Changes labels and names of the objects that were found, and the label map, before anything is written.
  std::function<void(std::vector<ObjectResult>&, Image<std::uint16_t>&)> relabel = {};
};

/// The same for one frame. \throws as segment.
SegmentResult segment_frame(const SegmentSettings& settings, const RunContext& context, const FrameStart& start);

/// What can be refused before any image is read: missing files, outputs that exist. \throws as segment.
void check_before_work(const SegmentSettings& settings);

}  // namespace pellicle
