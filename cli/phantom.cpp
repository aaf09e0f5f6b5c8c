#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "command_flags.h"
#include "commands.h"
#include "pellicle/base/atomic_file.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/base/parallel.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/output/outputs.h"
#include "phantom_settings.h"

namespace pellicle::cli {
namespace fs = std::filesystem;

namespace {

fs::path path_of(const PhantomCommand& command, const std::string& suffix) {
  return command.output / (command.name + suffix);
}

VolumeHeader header_of(const ImageGrid& grid) {
  VolumeHeader header;
  header.grid = grid;
  header.unit = "mm";
  return header;
}

std::string write_single(const PhantomCommand& command, const PhantomSettings& settings, Console& console) {
  Phantom phantom = make_phantom(settings);
  check_interrupt();
  if (command.seeds && *command.seeds != static_cast<int>(phantom.seeds.size())) {
    RandomEngine random(settings.seed);
    phantom.seeds = draw_seeds(phantom, *command.seeds, random);
  }
  console.progress(0.8, "writing");
  create_folder(command.output);
  const VolumeHeader header = header_of(phantom.image.grid);
  write_volume(path_of(command, ".nii.gz"), phantom.image, header);
  write_volume(path_of(command, "_truth.nii.gz"), phantom.truth, header);
  write_mesh(path_of(command, "_truth.ply"), phantom.truth_surface, MeshFormat::ply);
  write_text_file(path_of(command, "_truth.json"), truth_json(phantom));
  return fmt::format("{} {:.6g} ml", settings.shape, phantom.exact_volume_ml);
}

std::string write_cluster(const PhantomCommand& command, const ClusterSettings& settings, Console& console) {
  const Cluster cluster = make_cluster(settings);
  check_interrupt();
  console.progress(0.8, "writing");
  create_folder(command.output);
  const VolumeHeader header = header_of(cluster.image.grid);
  write_volume(path_of(command, ".nii.gz"), cluster.image, header);
  write_volume(path_of(command, "_truth.nii.gz"), cluster.truth, header);
  write_text_file(path_of(command, "_truth.json"), truth_json(cluster));
  double volume_ml = 0.0;
  for (const Body& body : cluster.bodies) volume_ml += exact_volume(body.shape) / 1000.0;
  return fmt::format("cluster of {} {:.6g} ml", cluster.bodies.size(), volume_ml);
}

int run_phantom(const PhantomCommand& command, Console& console) {
  std::vector<fs::path> outputs{path_of(command, ".nii.gz"), path_of(command, "_truth.nii.gz"),
                                path_of(command, "_truth.json")};
  if (!command.is_cluster()) outputs.push_back(path_of(command, "_truth.ply"));
  check_outputs(outputs, command.overwrite, {});
  const ThreadLimit limit(command.threads);
  console.progress(0.0, "rendering");
  const std::string made = command.is_cluster() ? write_cluster(command, command.cluster(), console)
                                                : write_single(command, command.phantom(), console);
  console.progress(1.0, "done");
  std::cout << fmt::format("{} {}\n", made, path_of(command, ".nii.gz").string());
  return 0;
}

}  // namespace

Run add_phantom(CLI::App& app) {
  app.footer(
      "Writes STEM.nii.gz, STEM_truth.nii.gz, STEM_truth.ply (not of a cluster) and STEM_truth.json.\n"
      "Example: pellicle phantom -o data --name bean --shape bean --radius 20 --snr 5 --seed 7\n"
      "Example: pellicle phantom -o data --name nuclei --shape cluster --count 30 --radius 4,7 --distance 0.9");
  return settings_command<PhantomCommand>(app, phantom_table(), run_phantom);
}

}  // namespace pellicle::cli
