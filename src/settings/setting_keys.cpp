#include <fmt/format.h>

#include <utility>

#include "pellicle/base/errors.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

namespace {

using Values = SettingValues;

/// What is the same for every kind of key.
struct Label {
  const char* group;
  const char* name;
  const char* placeholder;
  const char* help;
  const char* short_flag = "";
};

SettingKey key_from(const Label& label, SettingKind kind) {
  return {label.name, label.short_flag, label.group, label.placeholder, label.help, kind, false, {}, {}};
}

std::string text_of(double value) {
  return fmt::format("{}", value);
}

// `field` returns a reference to the member, for const and non-const settings alike.
template <class F>
SettingKey path_key(const Label& label, F field) {
  SettingKey key = key_from(label, SettingKind::text);
  key.set = [field](SegmentSettings& s, const Values& v, const std::string&) { field(s) = v.at(0); };
  key.get = [field](const SegmentSettings& s) -> Values {
    using T = std::decay_t<decltype(field(s))>;
    if constexpr (std::is_same_v<T, std::string>) {
      return field(s).empty() ? Values{} : Values{field(s)};
    } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
      return field(s).empty() ? Values{} : Values{field(s).string()};
    } else if constexpr (std::is_same_v<T, std::optional<std::filesystem::path>>) {
      return field(s) ? Values{field(s)->string()} : Values{};
    } else {
      return field(s) ? Values{*field(s)} : Values{};
    }
  };
  return key;
}

template <class F>
SettingKey flag_key(const Label& label, F field) {
  SettingKey key = key_from(label, SettingKind::flag);
  key.set = [field](SegmentSettings& s, const Values& v, const std::string& where) {
    if (v.at(0) != "true" && v.at(0) != "false") {
      throw UsageError(fmt::format("bad value ({}): '{}' is no choice; use true or false", where, v.at(0)));
    }
    field(s) = v.at(0) == "true";
  };
  key.get = [field](const SegmentSettings& s) { return Values{field(s) ? "true" : "false"}; };
  return key;
}

template <class F>
SettingKey enum_key(const Label& label, F field) {
  SettingKey key = key_from(label, SettingKind::text);
  key.set = [field](SegmentSettings& s, const Values& v, const std::string& where) {
    field(s) = value_of<std::decay_t<decltype(field(s))>>(v.at(0), where);
  };
  key.get = [field](const SegmentSettings& s) { return Values{name_of(field(s))}; };
  return key;
}

// An enumeration that need not be set.
template <class F>
SettingKey optional_enum_key(const Label& label, F field) {
  SettingKey key = key_from(label, SettingKind::text);
  key.set = [field](SegmentSettings& s, const Values& v, const std::string& where) {
    field(s) = value_of<typename std::decay_t<decltype(field(s))>::value_type>(v.at(0), where);
  };
  key.get = [field](const SegmentSettings& s) { return field(s) ? Values{name_of(*field(s))} : Values{}; };
  return key;
}

// int, double, and optionals of them.
template <class F>
SettingKey number_key(const Label& label, F field) {
  SettingKey key = key_from(label, SettingKind::number);
  using Number = std::decay_t<decltype(field(std::declval<SegmentSettings&>()))>;
  key.whole = std::is_same_v<Number, int> || std::is_same_v<Number, std::optional<int>>;
  key.set = [field](SegmentSettings& s, const Values& v, const std::string& where) {
    using T = std::decay_t<decltype(field(s))>;
    if constexpr (std::is_same_v<T, int> || std::is_same_v<T, std::optional<int>>) {
      field(s) = integer_of(v.at(0), where);
    } else {
      field(s) = number_of(v.at(0), where);
    }
  };
  key.get = [field](const SegmentSettings& s) -> Values {
    using T = std::decay_t<decltype(field(s))>;
    if constexpr (std::is_same_v<T, int> || std::is_same_v<T, double>) {
      return {fmt::format("{}", field(s))};
    } else {
      return field(s) ? Values{fmt::format("{}", *field(s))} : Values{};
    }
  };
  return key;
}

std::vector<double> numbers_of(const Values& words, std::size_t count, const std::string& where) {
  if (words.size() != count) {
    throw UsageError(
        fmt::format("bad value ({}): {} numbers are needed, separated by commas, not {}", where, count, words.size()));
  }
  std::vector<double> numbers;
  for (const auto& word : words) numbers.push_back(number_of(word, where));
  return numbers;
}

SettingKey seed_sphere_key() {
  SettingKey key = key_from({"Seed", "seed-sphere", "X,Y,Z,R",
                             "start sphere; coordinates as --coords says, radius in mm; repeat for several objects"},
                            SettingKind::vectors);
  key.set = [](SegmentSettings& s, const Values& v, const std::string& where) {
    s.seed_spheres.clear();
    for (const auto& one : v) {
      const auto n = numbers_of(split_commas(one), 4, where);
      s.seed_spheres.push_back({n[0], n[1], n[2], n[3]});
    }
  };
  key.get = [](const SegmentSettings& s) {
    Values values;
    for (const auto& b : s.seed_spheres) values.push_back(fmt::format("{},{},{},{}", b[0], b[1], b[2], b[3]));
    return values;
  };
  return key;
}

SettingKey seed_point_key() {
  SettingKey key = key_from({"Seed", "seed-point", "X,Y,Z",
                             "start sphere of radius --seed-radius; coordinates as --coords says; repeat for several "
                             "objects"},
                            SettingKind::vectors);
  key.set = [](SegmentSettings& s, const Values& v, const std::string& where) {
    s.seed_points.clear();
    for (const auto& one : v) {
      const auto n = numbers_of(split_commas(one), 3, where);
      s.seed_points.push_back({n[0], n[1], n[2]});
    }
  };
  key.get = [](const SegmentSettings& s) {
    Values values;
    for (const auto& x : s.seed_points) values.push_back(fmt::format("{},{},{}", x[0], x[1], x[2]));
    return values;
  };
  return key;
}

SettingKey spacing_key() {
  SettingKey key =
      key_from({"Input", "spacing", "X,Y,Z", "voxel size in mm, instead of the file's"}, SettingKind::vector);
  key.set = [](SegmentSettings& s, const Values& v, const std::string& where) {
    const auto n = numbers_of(v, 3, where);
    s.spacing = Vec3{n[0], n[1], n[2]};
  };
  key.get = [](const SegmentSettings& s) -> Values {
    if (!s.spacing) return {};
    return {text_of((*s.spacing)[0]), text_of((*s.spacing)[1]), text_of((*s.spacing)[2])};
  };
  return key;
}

SettingKey radius_key() {
  SettingKey key =
      key_from({"Seed", "radius", "MIN,MAX", "radii of many objects, mm; default: estimated from the image"},
               SettingKind::vector);
  key.set = [](SegmentSettings& s, const Values& v, const std::string& where) {
    const auto n = numbers_of(v, 2, where);
    s.radius = RadiusRange{n[0], n[1]};
  };
  key.get = [](const SegmentSettings& s) -> Values {
    if (!s.radius) return {};
    return {text_of(s.radius->min), text_of(s.radius->max)};
  };
  return key;
}

SettingKey model_key() {
  SettingKey key =
      key_from({"Model", "model", "normal|spline|spline-torus|catmull-clark|slime",
                "surface model; spline: exponential-spline sphere; of many objects catmull-clark unless named"},
               SettingKind::text);
  key.set = [](SegmentSettings& s, const Values& v, const std::string& where) {
    s.model = s.fit.model.kind = value_of<ModelKind>(v.at(0), where);
  };
  key.get = [](const SegmentSettings& s) { return Values{name_of(s.model_kind())}; };
  return key;
}

SettingKey write_key() {
  SettingKey key =
      key_from({"Outputs", "write", "LIST", "of mask,mesh,model,report,qc,convergence,sdf,prob"}, SettingKind::words);
  key.set = [](SegmentSettings& s, const Values& v, const std::string&) { s.write = v; };
  key.get = [](const SegmentSettings& s) { return s.write; };
  return key;
}

SettingKey energy_key() {
  SettingKey key = key_from({"Energies", "energy", "NAME=WEIGHT",
                             "weight of one energy in every stage; repeat, or A=1,B=2; '--energy list' explains each"},
                            SettingKind::table);
  key.set = [](SegmentSettings& s, const Values& v, const std::string& where) {
    for (const auto& word : v) {
      for (const auto& one : split_commas(word)) {
        const auto equals = one.find('=');
        if (equals == std::string::npos || equals == 0) {
          throw UsageError(fmt::format("bad value ({}): '{}' is not NAME=WEIGHT; see --energy list", where, one));
        }
        s.fit.energies[energy_named(one.substr(0, equals), where)] = number_of(one.substr(equals + 1), where);
      }
    }
  };
  key.get = [](const SegmentSettings& s) {
    Values values;
    for (const auto& [kind, weight] : s.fit.energies) values.push_back(fmt::format("{}={}", kind->name, weight));
    return values;
  };
  return key;
}

// A member pointer cannot reach into a nested struct, so a name stands for reading and writing it alike.
// NOLINTBEGIN(bugprone-macro-parentheses): `member` is a name, not an expression.
#define FIELD(member)    \
  [](auto& s) -> auto& { \
    return s.member;     \
  }
// NOLINTEND(bugprone-macro-parentheses)

void add_input_and_seed(std::vector<SettingKey>& keys) {
  keys.push_back(path_key(
      {"Input", "input", "VOLUME", ".nii .nii.gz .nrrd .mha .mhd .tif ... or a folder holding one DICOM series", "-i"},
      FIELD(input)));
  keys.push_back(spacing_key());
  keys.push_back(seed_sphere_key());
  keys.push_back(seed_point_key());
  keys.push_back(number_key({"Seed", "seed-radius", "MM", "radius of every --seed-point, mm"}, FIELD(seed_radius)));
  keys.push_back(path_key({"Seed", "seeds", "FILE.csv", "columns x,y,z,r[,label[,name]], in the frame of --coords"},
                          FIELD(seeds_file)));
  keys.push_back(
      path_key({"Seed", "seed-mask", "FILE[:LABEL]", "start from a mask or label map; every label when none is named"},
               FIELD(seed_mask)));
  keys.push_back(path_key({"Seed", "seed-model", "FILE.json", "start from a saved model"}, FIELD(seed_model)));
  keys.push_back(flag_key({"Seed", "seed-auto", "", "find the object; this is what happens when no seed is given"},
                          FIELD(seed_auto)));
  keys.push_back(
      enum_key({"Seed", "objects", "one|many",
                "one object, or many of one kind (nuclei, cells): found, or one a seed where seeds are given"},
               FIELD(objects)));
  keys.push_back(radius_key());
  keys.push_back(number_key({"Seed", "valley", "SHARE",
                             "of many objects: two are one unless the response between them falls below this share of "
                             "the weaker; nearer 1 splits more"},
                            FIELD(valley)));
  keys.push_back(enum_key({"Seed", "coords", "lps|ras|ijk",
                           "frame of coordinates: mm in LPS or RAS, or 0-based voxel index (radii stay in mm)"},
                          FIELD(coords)));
}

void add_solver(std::vector<SettingKey>& keys) {
  keys.push_back(
      number_key({"Energies", "max-iterations", "N", "steps of each stage at most"}, FIELD(fit.max_iterations)));
  keys.push_back(
      number_key({"Energies", "tolerance", "T", "a stage ends when the mean move of a step falls below T voxels"},
                 FIELD(fit.tolerance)));
  keys.push_back(optional_enum_key({"Energies", "solver", "least-squares|levenberg-marquardt|gradient|dynamic",
                                    "how every stage is solved; dynamic: a moving surface with mass and damping; "
                                    "default by stage (least-squares)"},
                                   FIELD(fit.solver)));
  keys.push_back(number_key({"Energies", "time-step", "T", "of --solver dynamic; default 1"}, FIELD(fit.time_step)));
  keys.push_back(
      number_key({"Energies", "mass", "M", "of --solver dynamic; 0: no inertia; default 0.1"}, FIELD(fit.mass)));
  keys.push_back(number_key({"Energies", "damping", "D", "of --solver dynamic; default 1"}, FIELD(fit.damping)));
  keys.push_back(number_key({"Energies", "error-target", "MM",
                             "refine until the rms distance to the edges (and to --points) is so small, and no "
                             "further; by default the fit decides"},
                            FIELD(fit.error_target_mm)));
}

void add_model_and_energies(std::vector<SettingKey>& keys) {
  keys.push_back(model_key());
  keys.push_back(number_key(
      {"Model", "detail", "N", "refinements of the control mesh at most (0: as seeded); by default the fit decides"},
      FIELD(fit.detail)));
  keys.push_back(
      enum_key({"Model", "rule", "smooth|published|balanced", "subdivision rule of normal"}, FIELD(fit.model.rule)));
  keys.push_back(
      enum_key({"Model", "start", "tetrahedron|octahedron|icosahedron", "solid of normal's first control mesh"},
               FIELD(fit.model.solid)));
  keys.push_back(enum_key({"Model", "start-rule", "auto|sphere|rays|head",
                           "how a seed becomes a start: as it is, first edges along rays, or the brain in a head"},
                          FIELD(fit.start_rule)));
  keys.push_back(path_key(
      {"Energies", "preset", "NAME", "named bundle of settings, or a TOML file; '--preset list' prints them all"},
      FIELD(preset)));
  keys.push_back(energy_key());
  keys.push_back(
      enum_key({"Energies", "polarity", "bright|dark|auto", "object against its background"}, FIELD(fit.polarity)));
  keys.push_back(
      enum_key({"Energies", "boundary", "auto|step|ridge", "a change of level, or a thin bright or dark membrane"},
               FIELD(fit.boundary)));
  keys.push_back(number_key({"Energies", "smoothing", "MM", "Gaussian scale of the image forces, mm; default by stage"},
                            FIELD(fit.smoothing_mm)));
  keys.push_back(number_key({"Energies", "target-volume", "ML", "volume that the object should have, ml"},
                            FIELD(fit.target_volume_ml)));
  keys.push_back(number_key({"Energies", "volume-weight", "W", "weight of --target-volume"}, FIELD(fit.volume_weight)));
  keys.push_back(
      flag_key({"Energies", "similarity", "", "also try 'alike the seed' when the grey levels are uncertain"},
               FIELD(fit.similarity)));
  keys.push_back(path_key({"Energies", "points", "FILE",
                           "expert points, in the frame of --coords: .csv x,y,z[,weight], .ply, .xyz; the surface is "
                           "pulled to them"},
                          FIELD(points)));
  keys.push_back(enum_key({"Energies", "points-pull", "normal|point",
                           "the surface along its normal to where a point lies (it may slide), or its nearest place "
                           "to the point itself"},
                          FIELD(points_pull)));
  add_solver(keys);
}

void add_outputs_and_run(std::vector<SettingKey>& keys) {
  keys.push_back(path_key({"Outputs", "output", "DIR", "output folder, created if missing", "-o"}, FIELD(output)));
  keys.push_back(path_key({"Outputs", "name", "STEM", "file stem; default: the input's name without its extensions"},
                          FIELD(name)));
  keys.push_back(write_key());
  keys.push_back(enum_key({"Outputs", "mesh-format", "ply|stl|obj|vtp|gii", "format of the mesh"}, FIELD(mesh_format)));
  keys.push_back(number_key(
      {"Outputs", "mesh-density", "N", "2^N facets along a control edge; default: facets of about half a voxel"},
      FIELD(mesh_density)));
  keys.push_back(path_key({"Outputs", "trace", "DIR",
                           "also write the surface every few steps of the fit and a picture of all of them there"},
                          FIELD(trace)));
  keys.push_back(
      number_key({"Outputs", "trace-every", "N", "steps between two meshes of --trace"}, FIELD(trace_every)));
  keys.push_back(
      path_key({"Outputs", "output-mask", "FILE.nii.gz",
                "also write the mask, or the label map of several objects, to this file; -o is not needed then"},
               FIELD(output_mask)));
  keys.push_back(path_key({"Outputs", "output-mesh", "FILE",
                           "also write the mesh, of several objects as one, to this file: .ply .stl .obj .vtp .gii"},
                          FIELD(output_mesh)));
  keys.push_back(flag_key({"Outputs", "overwrite", "", "replace files that exist"}, FIELD(overwrite)));
  keys.push_back(number_key({"Run", "threads", "N", "threads; 0: all. The results are the same bytes for every N"},
                            FIELD(threads)));
  keys.push_back(flag_key(
      {"Run", "dry-run", "",
       "print the resolved settings as TOML, with -i and -o also what would be done, draw the seeds, and stop"},
      FIELD(dry_run)));
  keys.push_back(flag_key({"Run", "quiet", "", "errors only on stderr", "-q"}, FIELD(quiet)));
  keys.push_back(flag_key({"Run", "verbose", "", "tell what is going on", "-v"}, FIELD(verbose)));
  keys.push_back(flag_key({"Run", "log-json", "", "logs as one JSON object a line"}, FIELD(log_json)));
  keys.push_back(flag_key({"Run", "no-progress", "", "no progress bar"}, FIELD(no_progress)));
  keys.push_back(
      flag_key({"Run", "progress-xml", "", "progress on stdout as 3D Slicer reads it"}, FIELD(progress_xml)));
}

#undef FIELD

}  // namespace

const std::vector<SettingKey>& segment_keys() {
  static const std::vector<SettingKey> all = [] {
    std::vector<SettingKey> keys;
    add_input_and_seed(keys);
    add_model_and_energies(keys);
    add_outputs_and_run(keys);
    return keys;
  }();
  return all;
}

}  // namespace pellicle
