// Shape reconstruction: meshes of genus 0 as splines of M x M control points; noisy clouds of shapes of any genus and
// scans as Catmull-Clark and slime surfaces; how few control points an error of 1 % takes.

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/random.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/output/fit_files.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

void print_row(const std::string& file, const GeometryFitResult& result, const std::string& true_genus) {
  const double percent = 100.0 / result.input.data.diameter;
  for (const FittedSurface& fitted : result.fit.sizes.tried) {
    if (result.settings.ladder.empty() && &fitted != &result.fit.sizes.best()) continue;
    const PointFitSummary& s = fitted.fit.summary;
    fmt::print("| {} | {} | {} | {} | {} | {:.3f} | {:.2f} | {:.3f} | {:.2f} | {} / {} | {} | {:.1f} |\n", file,
               to_string(result.input.kind), model_name(fitted.fit.surface.model), fitted.name, s.control_points,
               percent * s.to_surface.rms, percent * s.to_surface.max, percent * s.to_data.rms, percent * s.to_data.max,
               s.genus, true_genus, s.self_intersections, s.seconds);
  }
  std::fflush(stdout);
}

void try_fit(const Options& options, const std::filesystem::path& path, GeometryFitSettings settings,
             const std::string& true_genus = "") {
  const std::string file = path.filename().string();
  if (!std::filesystem::exists(path)) {
    fmt::print("| {} | not there | | | | | | | | | | |\n", file);
    return;
  }
  settings.input = path.string();
  settings.output = options.scratch;
  settings.overwrite = true;
  settings.write = {"report"};
  try {
    print_row(file, fit_to_files(settings, {}, {}), true_genus);
  } catch (const std::exception& fault) {
    fmt::print("| {} | fails: {} | | | | | | | | | | |\n", file, fault.what());
  }
}

/// Points spread evenly over a mesh with noise of 0.2 % of its diameter in each direction; where they were written.
std::filesystem::path noisy_cloud(const Options& options, const std::string& file, const TriangleMesh& mesh,
                                  int count) {
  constexpr double kNoise = 0.002;
  const double noise = kNoise * diameter_of(mesh.vertices);
  RandomEngine random(static_cast<std::uint64_t>(count));
  std::string text;
  for (const Vec3& x : sample_surface(mesh, count)) {
    const Vec3 y = x + noise * Vec3(random.normal(), random.normal(), random.normal());
    text += fmt::format("{:.9g} {:.9g} {:.9g}\n", y.x(), y.y(), y.z());
  }
  std::filesystem::create_directories(options.scratch);
  const auto path = options.scratch / fmt::format("{}-{}.xyz", std::filesystem::path(file).stem().string(), count);
  write_text_file(path, text);
  return path;
}

void noisy_clouds(const Options& options, const std::string& file) {
  const auto path = options.data / "shapes" / file;
  if (!std::filesystem::exists(path)) return;
  const TriangleMesh mesh = read_mesh(path);
  const std::string genus = std::to_string(topology_of(mesh).genus);
  for (const int count : {2000, 20000}) {
    GeometryFitSettings settings;
    settings.model.kind = ModelKind::catmull_clark;
    const auto cloud = noisy_cloud(options, file, mesh, count);
    try_fit(options, cloud, settings, genus);
    if (count > 2000) continue;
    settings.model.kind = ModelKind::slime;
    try_fit(options, cloud, settings, genus);
  }
}

}  // namespace

void shape_table(const Options& options) {
  fmt::print(
      "\n## Shapes (rms, max: data to surface, % of the diameter; back: surface to data; genus found / true)\n\n"
      "| file | kind | model | size | points | rms | max | back rms | back max | genus | cuts | s "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const auto wanted = [&](const std::string& file) { return options.only.empty() || file.find(options.only) == 0; };
  const std::filesystem::path shapes = options.data / "shapes";
  GeometryFitSettings ladder;
  ladder.model.kind = ModelKind::spline;
  ladder.ladder = {10, 20, 40};
  for (const char* file : {"bunny.off", "cow.off", "spot.obj"}) {
    if (wanted(file)) try_fit(options, shapes / file, ladder, "0");
  }
  for (const char* file : {"spot.obj", "bunny.off", "cow.off", "rocker-arm.obj", "knot.ply", "3holes.off"}) {
    if (wanted(file)) noisy_clouds(options, file);
  }
  GeometryFitSettings quads;
  quads.model.kind = ModelKind::catmull_clark;
  for (const auto& [file, genus] : {std::pair("bunny16k.pts", "0"), std::pair("Horse_DERIVED.xyz", "0"),
                                    std::pair("Rocker_arm_DERIVED.xyz", "1")}) {
    if (wanted(file)) try_fit(options, shapes / file, quads, genus);
  }
  // About as many control points as the few hundred of Stoddart et al. 1994: the largest error that 386 points leave.
  GeometryFitSettings few = quads;
  few.tolerance_of = ToleranceOf::max;
  few.tolerance_percent = 1.0;
  for (const char* file : {"bunny.off", "spot.obj", "rocker-arm.obj", "3holes.off", "knot.ply"}) {
    if (wanted(file)) try_fit(options, shapes / file, few, "");
  }
}

}  // namespace pellicle::bench
