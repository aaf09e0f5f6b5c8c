#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "command_flags.h"
#include "command_settings.h"
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

void check_files(const ExportSettings& s) {
  std::vector<fs::path> outputs, inputs{s.model};
  for (const auto& path : {s.mesh, s.mask, s.sdf, s.prob, s.control}) {
    if (!path.empty()) outputs.push_back(path);
  }
  if (!s.like.empty()) inputs.push_back(s.like);
  if (!s.mesh.empty()) format_of(s.mesh);
  if (!s.control.empty()) format_of(s.control);
  check_outputs(outputs, s.overwrite, inputs);
}

void export_voxels(const ExportSettings& s, const Surface& surface) {
  const VolumeHeader header = read_header(s.like);
  const int level =
      s.density ? *s.density : std::clamp(tessellation_level(surface, 0.5 * header.grid.mean_spacing()), 2, 6);
  const TriangleMesh mesh = tessellate(surface, level);
  if (!s.mask.empty()) write_volume(s.mask, rasterize_mask(mesh, header.grid), header);
  if (!s.prob.empty()) write_volume(s.prob, rasterize_partial_volume(mesh, header.grid), header);
  if (!s.sdf.empty()) {
    write_volume(s.sdf, signed_distance(surface, mesh, header.grid), header);
  }
}

int run_export(const ExportSettings& s, Console& /*console*/) {
  check_files(s);
  const ThreadLimit limit(s.threads);
  const Surface surface = read_model(s.model);
  if (!s.mesh.empty()) {
    const int level = s.density ? *s.density : viewing_level(surface);
    write_mesh(s.mesh, tessellate(surface, level), format_of(s.mesh));
  }
  if (!s.control.empty()) write_mesh(s.control, control_mesh_of(surface), format_of(s.control));
  if (!s.like.empty()) export_voxels(s, surface);
  return 0;
}

}  // namespace

Run add_export(CLI::App& app) {
  app.footer(
      "Example: pellicle export out/scan_model.json --mesh dense.stl --density 6 --mask mask.nii.gz --like "
      "scan.nii.gz");
  return settings_command<ExportSettings>(app, export_table(), run_export);
}

}  // namespace pellicle::cli
