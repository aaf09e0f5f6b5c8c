#include "pellicle/output/trace.h"

#include <fmt/format.h>

#include <algorithm>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/output/outputs.h"
#include "pellicle/picture/contact_sheet.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

// STEM_trace-0001.ply, STEM_trace-002-0001.ply, STEM_trace.png ...: the stem, "_trace", digits and dashes, one
// extension.
bool is_of_trace(const fs::path& path, const std::string& stem) {
  const std::string name = path.filename().string(), start = stem + "_trace";
  if (!name.starts_with(start)) return false;
  const std::string rest = name.substr(start.size());
  const auto end = rest.find_first_not_of("-0123456789");
  return end != std::string::npos && rest[end] == '.';
}

std::vector<fs::path> earlier_files(const TraceFiles& files) {
  std::vector<fs::path> found;
  std::error_code fault;
  for (fs::directory_iterator at(files.folder, fault), end; !fault && at != end; at.increment(fault)) {
    if (is_of_trace(at->path(), files.stem)) found.push_back(at->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

void check_trace(const TraceFiles& files, bool overwrite) {
  const fs::path picture = files.folder / (files.stem + "_trace.png");
  check_outputs({picture}, overwrite, {});
  const std::vector<fs::path> found = earlier_files(files);
  if (!overwrite && !found.empty()) {
    throw CannotCreate(
        fmt::format("output exists (`trace` {}): {} is not replaced; give `overwrite`, another `name` "
                    "or folder",
                    files.folder.string(), found.front().filename().string()));
  }
}

void clear_trace(const TraceFiles& files) {
  std::error_code ignored;
  for (const fs::path& path : earlier_files(files)) fs::remove(path, ignored);
}

std::vector<fs::path> write_trace(const TraceFiles& files, const std::vector<TraceFrame>& frames, int label,
                                  const Observer& observer) {
  create_folder(files.folder);
  const std::string stem = files.stem + "_trace" + (label > 0 ? fmt::format("-{:03}", label) : "");
  const std::size_t digits = std::max<std::size_t>(4, fmt::format("{}", frames.size()).size());
  std::vector<fs::path> paths;
  std::vector<TriangleMesh> meshes;
  meshes.reserve(frames.size());  // the panels point into it
  std::vector<SheetPanel> panels;
  std::string table = "frame\tstage\tstep\tcontrol_points\tvolume_ml\n";
  for (std::size_t f = 0; f < frames.size(); ++f) {
    observer.check_stopped();
    const Surface& surface = frames[f].surface;
    meshes.push_back(tessellate(surface, files.mesh_density.value_or(viewing_level(surface))));
    const std::string number = fmt::format("{:0{}}", f + 1, digits);
    paths.push_back(files.folder / fmt::format("{}-{}{}", stem, number, extension_of(files.mesh_format)));
    write_mesh(paths.back(), meshes.back(), files.mesh_format);
    table += fmt::format("{}\t{}\t{}\t{}\t{:.6g}\n", number, frames[f].stage, frames[f].step,
                         control_point_count(surface.model), volume_with_normals(meshes.back()) / 1000.0);
    panels.push_back({&meshes.back(), fmt::format("{} {}", frames[f].stage, frames[f].step)});
  }
  paths.push_back(files.folder / (stem + ".tsv"));
  write_text_file(paths.back(), table);
  if (!panels.empty()) {
    paths.push_back(files.folder / (stem + ".png"));
    write_png(paths.back(), contact_sheet(panels, fmt::format("{}: {} of the fit's steps", stem, frames.size())));
  }
  return paths;
}

}  // namespace pellicle
