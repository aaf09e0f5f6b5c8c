// Sections that run the program itself, as its users do.

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "pellicle/base/errors.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/mask/moments.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/synthetic/phantom.h"
#include "sections.h"

extern char** environ;

namespace pellicle::bench {

namespace {

struct Run {
  int exit_code = -1;
  double seconds = 0.0;
};

Run run_program(const std::vector<std::string>& arguments) {
  // Through a shell: a process that is started directly counts this one's memory as its own peak.
  std::vector<std::string> words{"/bin/sh", "-c", "\"$0\" \"$@\"; exit $?", PELLICLE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", 1, 0);
  pid_t child = 0;
  const double begin = seconds_now();
  if (posix_spawn(&child, words[0].c_str(), &actions, nullptr, argv.data(), environ) != 0)
    throw IoError("cannot start " + words[0]);
  int status = 0;
  waitpid(child, &status, 0);
  posix_spawn_file_actions_destroy(&actions);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, seconds_now() - begin};
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

SeedDraw write_large_phantom(const std::filesystem::path& file) {
  PhantomSettings s;
  s.shape = "ellipsoid";
  s.size = {256, 256, 256};
  s.radius = {70.0};
  s.inside = 1000.0;
  s.outside = 200.0;
  const Phantom phantom = make_phantom(s);
  Image<std::int16_t> stored(phantom.image.grid);
  for (std::size_t i = 0; i < stored.voxels.size(); ++i) {
    stored.voxels[i] = static_cast<std::int16_t>(std::lround(phantom.image.voxels[i]));
  }
  VolumeHeader header;
  header.grid = stored.grid;
  write_volume(file, stored, header);
  return phantom.seeds.front();
}

double read_and_write_seconds(const std::filesystem::path& file, const std::filesystem::path& mask_file,
                              const std::filesystem::path& copy) {
  const Image<std::int32_t> labels = read_labels(mask_file).labels;
  const double begin = seconds_now();
  const Volume volume = read_volume(file);
  Image<std::uint8_t> mask(volume.image.grid);
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) mask.voxels[i] = labels.voxels[i] != 0 ? 1 : 0;
  write_volume(copy, mask, volume.header);
  return seconds_now() - begin;
}

}  // namespace

void storage_order_table(const Options& options) {
  fmt::print("\n## One anatomy in several storage orders\n\n");
  const std::filesystem::path folder = options.data / "bad-and-odd" / "made";
  if (!std::filesystem::exists(folder)) {
    fmt::print("skipped: no folder {}\n", folder.string());
    return;
  }
  fmt::print("| order | exit | largest distance to the first surface (mm) |\n|---|---|---|\n");
  // One ball, in mm: the middle of the labelled structure.
  const Image<std::int32_t> labels = read_labels(folder / "reoriented_LPS_label.nii.gz").labels;
  Image<std::uint8_t> mask(labels.grid);
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) mask.voxels[i] = labels.voxels[i] != 0 ? 1 : 0;
  const Vec3 c = moments_of(mask).centroid;
  const std::string ball = fmt::format("{:.4f},{:.4f},{:.4f},5", c[0], c[1], c[2]);
  std::optional<TriangleMesh> first;
  for (const std::string order : {"ASL", "IAL", "LAS", "LPS", "PSR"}) {
    const std::filesystem::path out = options.scratch / order;
    const Run run =
        run_program({"segment", "-i", (folder / ("reoriented_" + order + "_image.nii.gz")).string(), "-o", out.string(),
                     "--name", "x", "--seed-sphere", ball, "--write", "mesh", "--overwrite", "-q"});
    std::string distance = "-";
    if (std::filesystem::exists(out / "x_surface.ply")) {
      const TriangleMesh mesh = read_mesh(out / "x_surface.ply");
      if (!first) first = mesh;
      distance = fmt::format("{:.2e}", surface_distances(mesh, *first, 1.0).hd);
    }
    fmt::print("| {} | {} | {} |\n", order, run.exit_code, distance);
  }
}

void speed_table(const Options& options) {
  const std::filesystem::path file = options.scratch / "large.nii.gz", out = options.scratch / "large";
  const SeedDraw seed = write_large_phantom(file);
  const std::string ball = fmt::format("{},{},{},{}", seed.center[0], seed.center[1], seed.center[2], seed.radius);
  Run best;
  for (int round = 0; round < 3; ++round) {
    const Run run =
        run_program({"segment", "-i", file.string(), "-o", out.string(), "--seed-sphere", ball, "--overwrite", "-q"});
    if (round == 0 || run.seconds < best.seconds) best = run;
  }
  double io = 1e300;
  for (int round = 0; round < 3; ++round) {
    io = std::min(io, read_and_write_seconds(file, out / "large_mask.nii.gz", options.scratch / "copy.nii.gz"));
  }
  const double as_float = 4.0 * 256.0 * 256.0 * 256.0;
  const auto report = nlohmann::json::parse(std::ifstream(out / "large_report.json"));
  const double peak = report.at("peak_memory_bytes").get<double>();
  fmt::print("\n## 256^3 int16, object of radius 70 voxels (best of three)\n\n");
  fmt::print(
      "| read + write mask (s) | whole run (s) | ratio | peak memory / volume as float32 | exit "
      "|\n|---|---|---|---|---|\n");
  fmt::print("| {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} |\n", io, best.seconds, best.seconds / io, peak / as_float,
             best.exit_code);
}

void thread_table(const Options& options) {
  const Phantom phantom = make_phantom({.shape = "bean", .size = {80, 80, 80}});
  VolumeHeader header;
  header.grid = phantom.image.grid;
  const std::filesystem::path file = options.scratch / "bean.nii.gz";
  write_volume(file, phantom.image, header);
  const SeedDraw seed = phantom.seeds.front();
  const std::string sphere = fmt::format("{},{},{},{}", seed.center[0], seed.center[1], seed.center[2], seed.radius);
  for (const std::string threads : {"1", "2"}) {
    run_program({"segment", "-i", file.string(), "-o", (options.scratch / ("threads" + threads)).string(), "--name",
                 "x", "--seed-sphere", sphere, "--threads", threads, "--overwrite", "-q"});
  }
  fmt::print("\n## --threads 1 against --threads 2\n\n| file | identical bytes |\n|---|---|\n");
  for (const std::string name : {"x_mask.nii.gz", "x_surface.ply", "x_model.json"}) {
    const std::string one = bytes_of(options.scratch / "threads1" / name),
                      two = bytes_of(options.scratch / "threads2" / name);
    fmt::print("| {} | {} |\n", name, !one.empty() && one == two ? "yes" : "NO");
  }
}

}  // namespace pellicle::bench
