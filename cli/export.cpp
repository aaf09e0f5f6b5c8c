#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <iostream>

#include "commands.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/job/voxels.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/output/outputs.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/surface/model_file.h"

namespace pellicle::cli {
namespace fs = std::filesystem;

namespace {

struct ExportFlags {
  fs::path model, mesh, mask, sdf, prob, control, like;
  int density = -1, threads = 0;
  bool overwrite = false;
  ConsoleOptions* console = nullptr;
};

MeshFormat format_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension.size() < 2) {
    throw UsageError(fmt::format("bad value ({}): the name needs an extension; use .ply, .stl, .obj, .vtp or .surf.gii",
                                 path.string()));
  }
  return mesh_format_from_name(extension.substr(1));
}

void check_volume_name(const fs::path& path, const std::string& flag) {
  const std::string name = path.string();
  if (!path.empty() && !name.ends_with(".nii") && !name.ends_with(".nii.gz")) {
    throw UsageError(
        fmt::format("bad value (--{} {}): voxels are written as NIfTI; end the name in .nii.gz", flag, name));
  }
}

void check_flags(const ExportFlags& f) {
  const bool volumes = !f.mask.empty() || !f.sdf.empty() || !f.prob.empty();
  if (!volumes && f.mesh.empty() && f.control.empty()) {
    throw UsageError(
        "nothing to export (pellicle export): no output is named; give --mesh, --mask, --sdf, --prob or --control");
  }
  if (volumes && f.like.empty()) {
    throw UsageError("missing flag (--like): voxels need a grid; give --like VOLUME");
  }
  if (f.density != -1 && (f.density < 0 || f.density > 7)) {
    throw UsageError(
        fmt::format("bad value (--density {}): must be 0 to 7 (2^N facets along a control edge)", f.density));
  }
  check_volume_name(f.mask, "mask");
  check_volume_name(f.sdf, "sdf");
  check_volume_name(f.prob, "prob");
  std::vector<fs::path> outputs, inputs{f.model};
  for (const auto& path : {f.mesh, f.mask, f.sdf, f.prob, f.control}) {
    if (!path.empty()) outputs.push_back(path);
  }
  if (!f.like.empty()) inputs.push_back(f.like);
  if (!f.mesh.empty()) format_of(f.mesh);
  if (!f.control.empty()) format_of(f.control);
  check_outputs(outputs, f.overwrite, inputs);
}

void export_voxels(const ExportFlags& f, const Surface& surface) {
  const VolumeHeader header = read_header(f.like);
  const int level =
      f.density >= 0 ? f.density : std::clamp(tessellation_level(surface, 0.5 * header.grid.mean_spacing()), 2, 6);
  const TriangleMesh mesh = tessellate(surface, level);
  if (!f.mask.empty()) write_volume(f.mask, rasterize_mask(mesh, header.grid), header);
  if (!f.prob.empty()) write_volume(f.prob, rasterize_partial_volume(mesh, header.grid), header);
  if (!f.sdf.empty()) {
    write_volume(f.sdf, signed_distance(surface, mesh, header.grid), header);
  }
}

int run_export(const ExportFlags& f, Console& console) {
  console.configure(*f.console);
  check_flags(f);
  const ThreadLimit limit(f.threads);
  const Surface surface = read_model(f.model);
  if (!f.mesh.empty()) {
    const int level = f.density >= 0 ? f.density : viewing_level(surface);
    write_mesh(f.mesh, tessellate(surface, level), format_of(f.mesh));
  }
  if (!f.control.empty()) write_mesh(f.control, control_mesh_of(surface), format_of(f.control));
  if (!f.like.empty()) export_voxels(f, surface);
  return 0;
}

}  // namespace

Run add_export(CLI::App& app) {
  auto flags = std::make_shared<ExportFlags>();
  app.add_option("MODEL", flags->model, "a saved model, STEM_model.json")->type_name("FILE.json")->required();
  app.add_option("--mesh", flags->mesh, "mesh file; .ply, .stl, .obj, .vtp (LPS mm) or .surf.gii (RAS mm)")
      ->type_name("FILE")
      ->group("Outputs");
  app.add_option("--density", flags->density,
                 "2^N facets along a control edge; default: about 300 facets around the object")
      ->type_name("N")
      ->group("Outputs");
  app.add_option("--control", flags->control, "the control mesh, same formats")->type_name("FILE")->group("Outputs");
  app.add_option("--mask", flags->mask, "0/1 on the grid of --like")->type_name("FILE.nii.gz")->group("Outputs");
  app.add_option("--sdf", flags->sdf, "signed distance in mm, negative inside, on the grid of --like")
      ->type_name("FILE.nii.gz")
      ->group("Outputs");
  app.add_option("--prob", flags->prob, "inside fraction of each voxel on the grid of --like")
      ->type_name("FILE.nii.gz")
      ->group("Outputs");
  app.add_option("--like", flags->like, "volume whose grid is used")->type_name("VOLUME")->group("Outputs");
  app.add_flag("--overwrite", flags->overwrite, "replace files that exist")->group("Outputs");
  app.add_option("--threads", flags->threads, "threads; 0: all")->type_name("N")->capture_default_str()->group("Run");
  flags->console = add_console_flags(app);
  app.footer(
      "Example: pellicle export out/scan_model.json --mesh dense.stl --density 6 --mask mask.nii.gz --like "
      "scan.nii.gz");
  return [flags](Console& console) { return run_export(*flags, console); };
}

}  // namespace pellicle::cli
