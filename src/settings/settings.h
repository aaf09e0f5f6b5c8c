#pragma once
/// Everything that `pellicle segment` can be told, and the one table that spells it: a setting is a flag of the
/// command line, a key of a TOML file and a key of the report under the same name.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/options.h"
#include "pellicle/fit/plan.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/seed/blob_scale_space.h"

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
  std::string preset;                           ///< as named by the user; its values are already in the rest
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
  bool overwrite = false, dry_run = false;
  bool quiet = false, log_json = false, no_progress = false, verbose = false, progress_xml = false;

  /// Whether the output folder gets this kind; false for all when there is no folder.
  bool writes(const std::string& kind) const;
  /// `seed_spheres`, then `seed_points`.
  std::vector<std::array<double, 4>> all_seed_spheres() const;
  /// `model` or, for many objects, Catmull-Clark, else the normal model.
  ModelKind model_kind() const;
  /// Whether several objects are asked for, so that a label map is written however many there are.
  bool wants_many() const { return objects == Objects::many; }
  /// \throws UsageError naming the flag, its value and the rule. Does not look at any file.
  void validate() const;
  /// The same without the need for an input and an output.
  void validate_values() const;
};

/// The plan that runs, by the seeds that are given.
FitPlan plan_of(const SegmentSettings& settings);

/// The stem of the output files: `name`, or the input's file name without the extensions of volume files.
std::string stem_of(const SegmentSettings& settings);

/// Values as text: what stands after a flag, or the elements of a TOML array. Numbers read back to the same bits.
using SettingValues = std::vector<std::string>;

enum class SettingKind {
  flag,     ///< true or false
  number,   ///< one number
  text,     ///< one word, path or name
  words,    ///< list of words; on the command line separated by commas
  vector,   ///< numbers; on the command line separated by commas
  vectors,  ///< several of them; the flag is repeated
  table,    ///< NAME=NUMBER; the flag is repeated; a TOML table
};

struct SettingKey {
  std::string name;         ///< "seed-sphere": key of TOML and JSON; the flag is "--" + name
  std::string short_flag;   ///< "-i" or empty
  std::string group;        ///< heading in the help
  std::string placeholder;  ///< "X,Y,Z,R"
  std::string help;         ///< with unit and default
  SettingKind kind = SettingKind::text;
  bool whole = false;  ///< of a number: an integer
  /// \param where is named in the error. \throws UsageError.
  std::function<void(SegmentSettings&, const SettingValues&, const std::string& where)> set;
  std::function<SettingValues(const SegmentSettings&)> get;  ///< empty: not set

  /// The words that it takes, one of them, as the placeholder lists them; empty for any other setting.
  std::vector<std::string> choices() const;
};

/// All settings in the order of the help. Stages are no flags: see settings_toml.h.
const std::vector<SettingKey>& segment_keys();

/// Words of the enumerations, as typed: "bright", "ridge", ...
std::string name_of(Coords value);
std::string name_of(Objects value);
std::string name_of(PointsPull value);
std::string name_of(Polarity value);
std::string name_of(Boundary value);
std::string name_of(StartRule value);
std::string name_of(Solver value);
std::string name_of(SubdivisionRule value);
std::string name_of(StartSolid value);
std::string name_of(ModelKind value);
std::string name_of(MeshFormat value);

/// The value that a word stands for. \throws UsageError listing the choices.
template <class E>
E value_of(const std::string& word, const std::string& where);

/// One finite number; nothing when the word is not one.
std::optional<double> number_in(const std::string& word);
std::optional<int> integer_in(const std::string& word);
/// The same. \throws UsageError that names `where`.
double number_of(const std::string& word, const std::string& where);
int integer_of(const std::string& word, const std::string& where);
/// "1,2,3" -> {"1", "2", "3"}.
std::vector<std::string> split_commas(const std::string& text);

}  // namespace pellicle
