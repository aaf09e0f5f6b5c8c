#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <tuple>
#include <utility>
#include <variant>

#include "commands.h"
#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/base/parallel.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/output/outputs.h"
#include "pellicle/settings/settings.h"
#include "pellicle/synthetic/cluster.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle::cli {
namespace fs = std::filesystem;

namespace {

struct PhantomFlags {
  fs::path output;
  std::string name, size, spacing, direction, radius, center, fill, contrast, noise, contrast_range;
  PhantomSettings settings;
  ClusterSettings cluster;  ///< its own part only
  std::int64_t seed = 1;
  int seeds = 8, threads = 0;
  bool overwrite = false;
  std::vector<std::string> single_only, cluster_only;  ///< flags given that go with one kind of phantom only
  ConsoleOptions* console = nullptr;

  bool is_cluster() const { return settings.shape == "cluster"; }
  fs::path path(const std::string& suffix) const { return output / (name + suffix); }
};

Vec3 vector_of(const std::string& text, const std::string& flag) {
  const auto n = three_numbers(text, fmt::format("--{} {}", flag, text));
  return {n[0], n[1], n[2]};
}

std::vector<double> numbers_of(const std::string& text, const std::string& flag) {
  std::vector<double> numbers;
  for (const auto& word : split_commas(text)) numbers.push_back(number_of(word, fmt::format("--{} {}", flag, text)));
  return numbers;
}

/// MIN,MAX; one number stands for both.
std::pair<double, double> range_of(const std::string& text, const std::string& flag) {
  const auto numbers = numbers_of(text, flag);
  if (numbers.empty() || numbers.size() > 2) {
    throw UsageError(fmt::format("bad value (--{} {}): MIN,MAX are needed, or one number", flag, text));
  }
  return {numbers.front(), numbers.back()};
}

std::string joined_shapes(const std::string& separator) {
  std::string names;
  for (const auto& shape : shape_names()) names += shape + separator;
  return names + "cluster";
}

/// What all phantoms have: grid, intensities, degradations.
PhantomSettings image_settings_of(const PhantomFlags& flags) {
  PhantomSettings settings = flags.settings;
  if (!flags.size.empty()) {
    const auto words = split_commas(flags.size);
    const std::string where = fmt::format("--size {}", flags.size);
    if (words.size() != 1 && words.size() != 3) {
      throw UsageError(fmt::format("bad value ({}): 3 whole numbers are needed, separated by commas", where));
    }
    for (std::size_t a = 0; a < 3; ++a) settings.size[a] = integer_of(words[words.size() == 1 ? 0 : a], where);
  }
  if (!flags.spacing.empty()) settings.spacing = vector_of(flags.spacing, "spacing");
  if (!flags.direction.empty()) settings.direction_degrees = vector_of(flags.direction, "direction");
  if (!flags.contrast.empty()) {
    const std::string where = fmt::format("--contrast {}", flags.contrast);
    const auto words = split_commas(flags.contrast);
    if (words.size() != 2) throw UsageError(fmt::format("bad value ({}): INSIDE,OUTSIDE are needed", where));
    settings.inside = number_of(words[0], where);
    settings.outside = number_of(words[1], where);
  }
  if (!flags.noise.empty()) settings.noise = phantom_noise_from_name(flags.noise);
  settings.seed = static_cast<std::uint64_t>(flags.seed);
  return settings;
}

PhantomSettings settings_of(const PhantomFlags& flags) {
  PhantomSettings settings = image_settings_of(flags);
  if (!flags.center.empty()) settings.center = vector_of(flags.center, "center");
  if (!flags.radius.empty()) settings.radius = numbers_of(flags.radius, "radius");
  if (!flags.fill.empty()) settings.fill = phantom_fill_from_name(flags.fill);
  settings.validate();
  return settings;
}

ClusterSettings cluster_settings_of(const PhantomFlags& flags) {
  ClusterSettings settings = flags.cluster;
  settings.image = image_settings_of(flags);
  settings.image.shape = PhantomSettings{}.shape;
  if (!flags.radius.empty()) std::tie(settings.radius_min, settings.radius_max) = range_of(flags.radius, "radius");
  if (!flags.contrast_range.empty()) {
    std::tie(settings.contrast_min, settings.contrast_max) = range_of(flags.contrast_range, "contrast-range");
  }
  settings.validate();
  return settings;
}

void check_flags(const PhantomFlags& flags) {
  const auto& names = shape_names();
  const std::string& shape = flags.settings.shape;
  if (!flags.is_cluster() && std::find(names.begin(), names.end(), shape) == names.end()) {
    throw UsageError(fmt::format("unknown shape (--shape {}): choose one of {}", shape, joined_shapes(", ")));
  }
  const auto& wrong = flags.is_cluster() ? flags.single_only : flags.cluster_only;
  if (!wrong.empty()) {
    throw UsageError(
        fmt::format("flag does not apply ({}): --shape {} has no use for it; leave it out", wrong.front(), shape));
  }
  if (flags.seeds < 0) throw UsageError(fmt::format("bad value (--seeds {}): must be 0 or more", flags.seeds));
  if (flags.threads < 0) throw UsageError(fmt::format("bad value (--threads {}): must be 0 or more", flags.threads));
  if (flags.name.empty() || flags.name.find('/') != std::string::npos) {
    throw UsageError(fmt::format("bad value (--name {}): must be a file stem without folders", flags.name));
  }
}

VolumeHeader header_of(const ImageGrid& grid) {
  VolumeHeader header;
  header.grid = grid;
  header.unit = "mm";
  return header;
}

std::string write_single(const PhantomFlags& flags, const PhantomSettings& settings, Console& console) {
  Phantom phantom = make_phantom(settings);
  check_interrupt();
  if (flags.seeds != static_cast<int>(phantom.seeds.size())) {
    RandomEngine random(settings.seed);
    phantom.seeds = draw_seeds(phantom, flags.seeds, random);
  }
  console.progress(0.8, "writing");
  create_folder(flags.output);
  const VolumeHeader header = header_of(phantom.image.grid);
  write_volume(flags.path(".nii.gz"), phantom.image, header);
  write_volume(flags.path("_truth.nii.gz"), phantom.truth, header);
  write_mesh(flags.path("_truth.ply"), phantom.truth_surface, MeshFormat::ply);
  write_text_file(flags.path("_truth.json"), truth_json(phantom));
  return fmt::format("{} {:.6g} ml", settings.shape, phantom.exact_volume_ml);
}

std::string write_cluster(const PhantomFlags& flags, const ClusterSettings& settings, Console& console) {
  const Cluster cluster = make_cluster(settings);
  check_interrupt();
  console.progress(0.8, "writing");
  create_folder(flags.output);
  const VolumeHeader header = header_of(cluster.image.grid);
  write_volume(flags.path(".nii.gz"), cluster.image, header);
  write_volume(flags.path("_truth.nii.gz"), cluster.truth, header);
  write_text_file(flags.path("_truth.json"), truth_json(cluster));
  double volume_ml = 0.0;
  for (const Body& body : cluster.bodies) volume_ml += exact_volume(body.shape) / 1000.0;
  return fmt::format("cluster of {} {:.6g} ml", cluster.bodies.size(), volume_ml);
}

int run_phantom(const PhantomFlags& flags, Console& console) {
  console.configure(*flags.console);
  check_flags(flags);
  std::variant<PhantomSettings, ClusterSettings> settings;
  if (flags.is_cluster()) {
    settings = cluster_settings_of(flags);
  } else {
    settings = settings_of(flags);
  }
  std::vector<fs::path> outputs{flags.path(".nii.gz"), flags.path("_truth.nii.gz"), flags.path("_truth.json")};
  if (!flags.is_cluster()) outputs.push_back(flags.path("_truth.ply"));
  check_outputs(outputs, flags.overwrite, {});
  const ThreadLimit limit(flags.threads);
  console.progress(0.0, "rendering");
  const auto* cluster = std::get_if<ClusterSettings>(&settings);
  const std::string made = cluster != nullptr ? write_cluster(flags, *cluster, console)
                                              : write_single(flags, std::get<PhantomSettings>(settings), console);
  console.progress(1.0, "done");
  std::cout << fmt::format("{} {}\n", made, flags.path(".nii.gz").string());
  return 0;
}

void add_shape_flags(CLI::App& app, PhantomFlags& f) {
  app.add_option("--shape", f.settings.shape, "the object; cluster: many ellipsoids and a label map")
      ->type_name(joined_shapes("|"))
      ->capture_default_str()
      ->group("Object");
  app.add_option("--radius", f.radius,
                 "mm: one scale, three half axes A,B,C, MAJOR,MINOR of a torus, or MIN,MAX of a cluster (default 5,8)")
      ->type_name("MM")
      ->default_str("20")
      ->group("Object");
  app.add_option("--center", f.center, "of the object, LPS mm; the volume's centre is 0,0,0")
      ->type_name("X,Y,Z")
      ->default_str("0,0,0")
      ->group("Object");
  app.add_option("--amplitude", f.settings.blob_amplitude, "of a blob: largest relative deviation from the ball")
      ->type_name("A")
      ->capture_default_str()
      ->group("Object");
  app.add_option("--fill", f.fill, "solid object or membrane")
      ->type_name("solid|shell")
      ->default_str("solid")
      ->group("Object");
  app.add_option("--shell-thickness", f.settings.shell_thickness_mm, "of the membrane, mm; 0: three voxels")
      ->type_name("MM")
      ->capture_default_str()
      ->group("Object");
}

void add_cluster_flags(CLI::App& app, PhantomFlags& f) {
  app.add_option("--count", f.cluster.count, "objects")->type_name("N")->capture_default_str()->group("Cluster");
  app.add_option("--distance", f.cluster.distance, "centres are at least D (r + r') apart; below 1 objects overlap")
      ->type_name("D")
      ->capture_default_str()
      ->group("Cluster");
  app.add_option("--elongation", f.cluster.elongation, "largest ratio of an object's half axes, 1 to 10")
      ->type_name("E")
      ->capture_default_str()
      ->group("Cluster");
  app.add_option("--contrast-range", f.contrast_range, "contrast of an object, relative to that of --contrast")
      ->type_name("MIN,MAX")
      ->default_str("1,1")
      ->group("Cluster");
}

void add_image_flags(CLI::App& app, PhantomFlags& f) {
  app.add_option("--size", f.size, "voxels")->type_name("NX,NY,NZ")->default_str("96,96,96")->group("Image");
  app.add_option("--spacing", f.spacing, "mm")->type_name("SX,SY,SZ")->default_str("1,1,1")->group("Image");
  app.add_option("--direction", f.direction, "turns the grid about x, then y, then z, degrees")
      ->type_name("RX,RY,RZ")
      ->default_str("0,0,0")
      ->group("Image");
  app.add_option("--contrast", f.contrast, "intensities")
      ->type_name("INSIDE,OUTSIDE")
      ->default_str("100,20")
      ->group("Image");
  app.add_option("--blur", f.settings.blur_mm, "standard deviation of the point spread, mm")
      ->type_name("MM")
      ->capture_default_str()
      ->group("Image");
  app.add_option("--noise", f.noise, "kind of noise")
      ->type_name("none|gaussian|rician|poisson")
      ->default_str("gaussian")
      ->group("Image");
  app.add_option("--snr", f.settings.snr, "contrast over the standard deviation of the noise")
      ->type_name("S")
      ->capture_default_str()
      ->group("Image");
  app.add_option("--bias", f.settings.bias, "smooth field from 1-B to 1+B over the volume, B in [0, 1)")
      ->type_name("B")
      ->capture_default_str()
      ->group("Image");
}

}  // namespace

Run add_phantom(CLI::App& app) {
  auto flags = std::make_shared<PhantomFlags>();
  app.add_option("-o,--output", flags->output, "output folder, created if missing")
      ->type_name("DIR")
      ->required()
      ->group("Outputs");
  app.add_option("--name", flags->name, "file stem")->type_name("STEM")->required()->group("Outputs");
  app.add_flag("--overwrite", flags->overwrite, "replace files that exist")->group("Outputs");
  add_shape_flags(app, *flags);
  add_cluster_flags(app, *flags);
  add_image_flags(app, *flags);
  app.add_option("--seed", flags->seed, "of the random numbers")
      ->type_name("INT")
      ->capture_default_str()
      ->group("Random");
  app.add_option("--seeds", flags->seeds, "start spheres that are drawn for the truth file")
      ->type_name("N")
      ->capture_default_str()
      ->group("Random");
  app.add_option("--threads", flags->threads, "threads; 0: all")->type_name("N")->capture_default_str()->group("Run");
  flags->console = add_console_flags(app);
  app.footer(
      "Writes STEM.nii.gz, STEM_truth.nii.gz, STEM_truth.ply (not of a cluster) and STEM_truth.json.\n"
      "Example: pellicle phantom -o data --name bean --shape bean --radius 20 --snr 5 --seed 7\n"
      "Example: pellicle phantom -o data --name nuclei --shape cluster --count 30 --radius 4,7 --distance 0.9");
  return [flags, &app](Console& console) {
    for (const char* flag : {"--center", "--amplitude", "--fill", "--shell-thickness", "--seeds"}) {
      if (app.count(flag) > 0) flags->single_only.emplace_back(flag);
    }
    for (const char* flag : {"--count", "--distance", "--elongation", "--contrast-range"}) {
      if (app.count(flag) > 0) flags->cluster_only.emplace_back(flag);
    }
    return run_phantom(*flags, console);
  };
}

}  // namespace pellicle::cli
