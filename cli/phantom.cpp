#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>

#include "commands.h"
#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/base/parallel.h"
#include "pellicle/image/volume_file.h"
#include "pellicle/mesh/mesh_file.h"
#include "pellicle/pipeline/outputs.h"
#include "pellicle/pipeline/settings.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle::cli {
namespace fs = std::filesystem;

namespace {

struct Flags {
  fs::path output;
  std::string name, size, spacing, direction, radius, center, fill, contrast, noise;
  PhantomSettings settings;
  std::int64_t seed = 1;
  int seeds = 8, threads = 0;
  bool overwrite = false;
  ConsoleOptions* console = nullptr;
};

Vec3 vector_of(const std::string& text, const std::string& flag) {
  const auto n = three_numbers(text, fmt::format("--{} {}", flag, text));
  return {n[0], n[1], n[2]};
}

PhantomSettings settings_of(const Flags& flags) {
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
  if (!flags.center.empty()) settings.center = vector_of(flags.center, "center");
  if (!flags.radius.empty()) {
    settings.radius.clear();
    for (const auto& word : split_commas(flags.radius)) {
      settings.radius.push_back(number_of(word, fmt::format("--radius {}", flags.radius)));
    }
  }
  if (!flags.contrast.empty()) {
    const std::string where = fmt::format("--contrast {}", flags.contrast);
    const auto words = split_commas(flags.contrast);
    if (words.size() != 2) throw UsageError(fmt::format("bad value ({}): INSIDE,OUTSIDE are needed", where));
    settings.inside = number_of(words[0], where);
    settings.outside = number_of(words[1], where);
  }
  if (!flags.fill.empty()) settings.fill = phantom_fill_from_name(flags.fill);
  if (!flags.noise.empty()) settings.noise = phantom_noise_from_name(flags.noise);
  settings.seed = static_cast<std::uint64_t>(flags.seed);
  settings.validate();
  return settings;
}

int run_phantom(const Flags& flags, Console& console) {
  console.configure(*flags.console);
  const PhantomSettings settings = settings_of(flags);
  if (flags.seeds < 0) throw UsageError(fmt::format("bad value (--seeds {}): must be 0 or more", flags.seeds));
  if (flags.threads < 0) throw UsageError(fmt::format("bad value (--threads {}): must be 0 or more", flags.threads));
  if (flags.name.empty() || flags.name.find('/') != std::string::npos) {
    throw UsageError(fmt::format("bad value (--name {}): must be a file stem without folders", flags.name));
  }
  const auto path = [&](const std::string& suffix) { return flags.output / (flags.name + suffix); };
  check_outputs({path(".nii.gz"), path("_truth.nii.gz"), path("_truth.ply"), path("_truth.json")}, flags.overwrite, {});

  const ThreadLimit limit(flags.threads);
  console.progress(0.0, "rendering");
  Phantom phantom = make_phantom(settings);
  check_interrupt();
  if (flags.seeds != static_cast<int>(phantom.seeds.size())) {
    RandomEngine random(settings.seed);
    phantom.seeds = draw_seeds(phantom, flags.seeds, random);
  }
  console.progress(0.8, "writing");
  create_folder(flags.output);
  VolumeHeader header;
  header.grid = phantom.image.grid;
  header.unit = "mm";
  write_volume(path(".nii.gz"), phantom.image, header);
  write_volume(path("_truth.nii.gz"), phantom.truth, header);
  write_mesh(path("_truth.ply"), phantom.truth_surface, MeshFormat::ply);
  write_text_file(path("_truth.json"), truth_json(phantom));
  console.progress(1.0, "done");
  std::cout << fmt::format("{} {:.6g} ml {}\n", settings.shape, phantom.exact_volume_ml, path(".nii.gz").string());
  return 0;
}

void add_shape_flags(CLI::App& app, Flags& f) {
  std::string shapes;
  for (const auto& shape : shape_names()) shapes += (shapes.empty() ? "" : "|") + shape;
  app.add_option("--shape", f.settings.shape, "the object")->type_name(shapes)->capture_default_str()->group("Object");
  app.add_option("--radius", f.radius, "mm: one scale, or three half axes A,B,C")
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

void add_image_flags(CLI::App& app, Flags& f) {
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
  auto flags = std::make_shared<Flags>();
  app.add_option("-o,--output", flags->output, "output folder, created if missing")
      ->type_name("DIR")
      ->required()
      ->group("Outputs");
  app.add_option("--name", flags->name, "file stem")->type_name("STEM")->required()->group("Outputs");
  app.add_flag("--overwrite", flags->overwrite, "replace files that exist")->group("Outputs");
  add_shape_flags(app, *flags);
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
      "Writes STEM.nii.gz, STEM_truth.nii.gz, STEM_truth.ply and STEM_truth.json.\n"
      "Example: pellicle phantom -o data --name bean --shape bean --radius 20 --snr 5 --seed 7");
  return [flags](Console& console) { return run_phantom(*flags, console); };
}

}  // namespace pellicle::cli
