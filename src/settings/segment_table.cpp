#include "pellicle/base/errors.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/settings/setting_fields.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

namespace {

Setting<SegmentSettings> spacing_row() {
  return setting<SegmentSettings>(
      {"Input", "spacing", "X,Y,Z", "voxel size in mm, instead of the file's"}, SettingKind::vector,
      [](SegmentSettings& s, const SettingKey& key, const SettingValues& values) {
        const auto n = numbers_of<double>(key, values, 3);
        s.spacing = Vec3{n[0], n[1], n[2]};
      },
      [](const SegmentSettings& s) -> SettingValues {
        if (!s.spacing) return {};
        const Vec3& x = *s.spacing;
        return SettingValue<std::array<double, 3>>::words({x[0], x[1], x[2]});
      });
}

Setting<SegmentSettings> radius_row() {
  return setting<SegmentSettings>(
      {"Seed", "radius", "MIN,MAX", "radii of many objects, mm; default: estimated from the image"},
      SettingKind::vector,
      [](SegmentSettings& s, const SettingKey& key, const SettingValues& values) {
        const auto n = numbers_of<double>(key, values, 2);
        s.radius = RadiusRange{n[0], n[1]};
      },
      [](const SegmentSettings& s) -> SettingValues {
        if (!s.radius) return {};
        return SettingValue<std::array<double, 2>>::words({s.radius->min, s.radius->max});
      });
}

Setting<SegmentSettings> model_row() {
  return setting<SegmentSettings>(
      {"Model", "model", "normal|spline|spline-torus|catmull-clark|slime",
       "surface model; spline: exponential-spline sphere; of many objects catmull-clark unless named"},
      SettingKind::text,
      [](SegmentSettings& s, const SettingKey& key, const SettingValues& values) {
        s.model = s.fit.model.kind = SettingValue<ModelKind>::read(key, values);
      },
      [](const SegmentSettings& s) { return SettingValues{name_of(s.model_kind())}; });
}

const EnergyKind& energy_of(const std::string& name, const SettingKey& key, const SettingValues& values) {
  const EnergyKind* kind = find_energy(name);
  if (kind == nullptr) refuse_setting(key, values, fmt::format("unknown energy '{}'; see `energy` list", name));
  return *kind;
}

void read_weights(SegmentSettings& s, const SettingKey& key, const SettingValues& values) {
  for (const auto& word : values) {
    for (const auto& one : split_commas(word)) {
      const auto equals = one.find('=');
      if (equals == std::string::npos || equals == 0) {
        refuse_setting(key, values, fmt::format("'{}' is not NAME=WEIGHT; see `energy` list", one));
      }
      s.fit.energies[energy_of(one.substr(0, equals), key, values)] =
          SettingValue<double>::read(key, {one.substr(equals + 1)});
    }
  }
}

Setting<SegmentSettings> energy_row() {
  return setting<SegmentSettings>(
      {"Energies", "energy", "NAME=WEIGHT",
       "weight of one energy in every stage; repeat, or A=1,B=2; '`energy` list' explains each"},
      SettingKind::table, read_weights, [](const SegmentSettings& s) {
        SettingValues values;
        for (const auto& [kind, weight] : s.fit.energies) {
          values.push_back(fmt::format("{}={}", kind->name, weight));
        }
        return values;
      });
}

void add_seed_rows(SettingTable<SegmentSettings>& table) {
  table.push_back(
      setting<SegmentSettings>({"Seed", "seed-sphere", "X,Y,Z,R",
                                "start sphere; coordinates as `coords` says, radius in mm; repeat for several objects"},
                               SETTING_FIELD(seed_spheres)));
  table.push_back(setting<SegmentSettings>(
      {"Seed", "seed-point", "X,Y,Z",
       "start sphere of radius `seed-radius`; coordinates as `coords` says; repeat for several "
       "objects"},
      SETTING_FIELD(seed_points)));
  table.push_back(setting<SegmentSettings>({"Seed", "seed-radius", "MM", "radius of every `seed-point`, mm"},
                                           SETTING_FIELD(seed_radius)));
  table.push_back(setting<SegmentSettings>(
      {"Seed", "seeds", "FILE.csv", "columns x,y,z,r[,label[,name]], in the frame of `coords`"},
      SETTING_FIELD(seeds_file)));
  table.push_back(setting<SegmentSettings>(
      {"Seed", "seed-mask", "FILE[:LABEL]", "start from a mask or label map; from every label when none is named"},
      SETTING_FIELD(seed_mask)));
  table.push_back(setting<SegmentSettings>({"Seed", "seed-model", "FILE.json", "start from a saved model"},
                                           SETTING_FIELD(seed_model)));
  table.push_back(
      setting<SegmentSettings>({"Seed", "seed-auto", "", "find the object; this is what happens when no seed is given"},
                               SETTING_FIELD(seed_auto)));
  table.push_back(setting<SegmentSettings>(
      {"Seed", "objects", "one|many",
       "one object, or many of one kind (nuclei, cells): those that are found, or one for each "
       "seed that is given"},
      SETTING_FIELD(objects)));
  table.push_back(radius_row());
  table.push_back(setting<SegmentSettings>(
      {"Seed", "valley", "FRACTION",
       "of many objects: two places are two objects only where the response between them falls "
       "below this fraction of the weaker one; nearer 1 splits more"},
      SETTING_FIELD(valley)));
  table.push_back(
      setting<SegmentSettings>({"Seed", "coords", "lps|ras|ijk",
                                "frame of coordinates: mm in LPS or RAS, or 0-based voxel index (radii stay in mm)"},
                               SETTING_FIELD(coords)));
}

void add_model_rows(SettingTable<SegmentSettings>& table) {
  table.push_back(model_row());
  table.push_back(
      setting<SegmentSettings>({"Model", "detail", "N",
                                "largest number of refinements of the control mesh (0: as seeded); by default the fit "
                                "decides"},
                               SETTING_FIELD(fit.detail)));
  table.push_back(
      setting<SegmentSettings>({"Model", "rule", "smooth|published|balanced", "subdivision rule of the model 'normal'"},
                               SETTING_FIELD(fit.model.rule)));
  table.push_back(setting<SegmentSettings>({"Model", "start", "tetrahedron|octahedron|icosahedron",
                                            "solid that the model 'normal' starts from, as its first control mesh"},
                                           SETTING_FIELD(fit.model.solid)));
  table.push_back(
      setting<SegmentSettings>({"Model", "start-rule", "auto|sphere|rays|head",
                                "how a seed becomes the first surface; sphere: as it is; rays: through the first edges "
                                "along rays; head: the brain in a head"},
                               SETTING_FIELD(fit.start_rule)));
}

void add_image_rows(SettingTable<SegmentSettings>& table) {
  table.push_back(setting<SegmentSettings>(
      {"Energies", "preset", "NAME", "named bundle of settings, or a TOML file; '`preset` list' prints them all"},
      SETTING_FIELD(preset)));
  table.push_back(energy_row());
  table.push_back(setting<SegmentSettings>(
      {"Energies", "polarity", "bright|dark|auto", "object against its background"}, SETTING_FIELD(fit.polarity)));
  table.push_back(setting<SegmentSettings>(
      {"Energies", "boundary", "auto|step|ridge", "step: a change of intensity; ridge: a thin bright or dark membrane"},
      SETTING_FIELD(fit.boundary)));
  table.push_back(setting<SegmentSettings>(
      {"Energies", "smoothing", "MM", "Gaussian scale of the image forces, mm; default by stage"},
      SETTING_FIELD(fit.smoothing_mm)));
  table.push_back(
      setting<SegmentSettings>({"Energies", "target-volume", "ML", "volume that the object should have, ml"},
                               SETTING_FIELD(fit.target_volume_ml)));
  table.push_back(setting<SegmentSettings>({"Energies", "volume-weight", "W", "weight of `target-volume`"},
                                           SETTING_FIELD(fit.volume_weight)));
  table.push_back(
      setting<SegmentSettings>({"Energies", "similarity", "",
                                "also try the hypothesis 'similar to the seed' when the intensities are uncertain"},
                               SETTING_FIELD(fit.similarity)));
  table.push_back(
      setting<SegmentSettings>({"Energies", "points", "FILE",
                                "expert points, in the frame of `coords`: .csv x,y,z[,weight], .ply, .xyz; the surface "
                                "is pulled to them"},
                               SETTING_FIELD(points)));
  table.push_back(
      setting<SegmentSettings>({"Energies", "points-pull", "normal|point",
                                "normal: pull the surface along its normal up to the point (it may slide); point: pull "
                                "the nearest place of the surface to the point itself"},
                               SETTING_FIELD(points_pull)));
}

void add_solver_rows(SettingTable<SegmentSettings>& table) {
  table.push_back(setting<SegmentSettings>({"Energies", "max-iterations", "N", "largest number of steps of each stage"},
                                           SETTING_FIELD(fit.max_iterations)));
  table.push_back(setting<SegmentSettings>(
      {"Energies", "tolerance", "T", "a stage ends when the mean move of a step falls below T voxels"},
      SETTING_FIELD(fit.tolerance)));
  table.push_back(setting<SegmentSettings>(
      {"Energies", "solver", "least-squares|levenberg-marquardt|gradient|dynamic",
       "how every stage is solved; dynamic: a moving surface with mass and damping; default by "
       "stage (least-squares)"},
      SETTING_FIELD(fit.solver)));
  table.push_back(setting<SegmentSettings>({"Energies", "time-step", "T", "of `solver` dynamic; default 1"},
                                           SETTING_FIELD(fit.time_step)));
  table.push_back(setting<SegmentSettings>({"Energies", "mass", "M", "of `solver` dynamic; 0: no inertia; default 0.1"},
                                           SETTING_FIELD(fit.mass)));
  table.push_back(setting<SegmentSettings>({"Energies", "damping", "D", "of `solver` dynamic; default 1"},
                                           SETTING_FIELD(fit.damping)));
  table.push_back(
      setting<SegmentSettings>({"Energies", "error-target", "MM",
                                "refine until the rms distance to the edges (and to `points`) is at most this, and no "
                                "further; by default the fit decides"},
                               SETTING_FIELD(fit.error_target_mm)));
}

void add_output_rows(SettingTable<SegmentSettings>& table) {
  table.push_back(setting<SegmentSettings>({"Outputs", "output", "DIR", "output folder, created if missing", "-o"},
                                           SETTING_FIELD(output)));
  table.push_back(setting<SegmentSettings>(
      {"Outputs", "name", "STEM", "file stem; default: the input's name without its extensions"}, SETTING_FIELD(name)));
  table.push_back(setting<SegmentSettings>(
      {"Outputs", "write", "LIST", "of mask,mesh,model,report,qc,convergence,sdf,prob"}, SETTING_FIELD(write)));
  table.push_back(setting<SegmentSettings>({"Outputs", "mesh-format", "ply|stl|obj|vtp|gii", "format of the mesh"},
                                           SETTING_FIELD(mesh_format)));
  table.push_back(setting<SegmentSettings>(
      {"Outputs", "mesh-density", "N", "2^N facets along a control edge; default: facets of about half a voxel"},
      SETTING_FIELD(mesh_density)));
  table.push_back(setting<SegmentSettings>(
      {"Outputs", "trace", "DIR",
       "also write to this folder the surface every few steps of the fit, and a picture of all "
       "of them"},
      SETTING_FIELD(trace)));
  table.push_back(setting<SegmentSettings>({"Outputs", "trace-every", "N", "steps between two meshes of `trace`"},
                                           SETTING_FIELD(trace_every)));
  table.push_back(setting<SegmentSettings>(
      {"Outputs", "output-mask", "FILE.nii.gz",
       "also write the mask, or the label map of several objects, to this file; `output` is not "
       "needed then"},
      SETTING_FIELD(output_mask)));
  table.push_back(setting<SegmentSettings>(
      {"Outputs", "output-mesh", "FILE",
       "also write the mesh, of several objects as one, to this file: .ply .stl .obj .vtp .gii"},
      SETTING_FIELD(output_mesh)));
  table.push_back(
      setting<SegmentSettings>({"Outputs", "overwrite", "", "replace files that exist"}, SETTING_FIELD(overwrite)));
  table.push_back(setting<SegmentSettings>(
      {"Run", "threads", "N", "threads; 0: all. The results are the same bytes for every N"}, SETTING_FIELD(threads)));
}

}  // namespace

const SettingTable<SegmentSettings>& segment_table() {
  static const SettingTable<SegmentSettings> all = [] {
    SettingTable<SegmentSettings> table;
    table.push_back(
        setting<SegmentSettings>({"Input", "input", "VOLUME",
                                  ".nii .nii.gz .nrrd .mha .mhd .tif ... or a folder holding one DICOM series", "-i"},
                                 SETTING_FIELD(input)));
    table.push_back(spacing_row());
    add_seed_rows(table);
    add_model_rows(table);
    add_image_rows(table);
    add_solver_rows(table);
    add_output_rows(table);
    return table;
  }();
  return all;
}

}  // namespace pellicle
