// Shape reconstruction: the meshes of genus 0 of the shared data as splines of M x M control points, and what the other
// models make of the same; point clouds and meshes with handles.

#include <fmt/format.h>

#include <cstdio>

#include "pellicle/pipeline/fit_points.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

void print_row(const std::string& file, const GeometryFitResult& result) {
  const double percent = 100.0 / result.input.data.diameter;
  for (const FittedSurface& fitted : result.tried) {
    const PointFitSummary& s = fitted.fit.summary;
    fmt::print("| {} | {} | {} | {} | {} | {:.3f} | {:.2f} | {:.3f} | {} | {:.1f} |\n", file, result.input.kind,
               result.input.genus, model_name(fitted.fit.surface.model), fitted.name, percent * s.to_surface.rms,
               percent * s.to_surface.max, percent * s.to_data.rms, s.self_intersections, s.seconds);
  }
  std::fflush(stdout);
}

void try_fit(const Options& options, const std::string& file, GeometryFitSettings settings) {
  const auto path = options.data / "shapes" / file;
  if (!std::filesystem::exists(path)) {
    fmt::print("| {} | not there | | | | | | | | |\n", file);
    return;
  }
  settings.input = path.string();
  settings.output = options.scratch;
  settings.overwrite = true;
  settings.write = {"report"};
  try {
    print_row(file, fit_geometry(settings, {}));
  } catch (const std::exception& fault) {
    fmt::print("| {} | fails: {} | | | | | | | | |\n", file, fault.what());
  }
}

}  // namespace

void shape_table(const Options& options) {
  fmt::print(
      "\n## Shapes (rms, max: data to surface, % of the diameter; back: surface to data)\n\n"
      "| file | kind | genus | model | size | rms | max | back | cuts | s "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n");
  const auto wanted = [&](const std::string& file) { return options.only.empty() || file.find(options.only) == 0; };
  GeometryFitSettings ladder;
  ladder.model.kind = ModelKind::spline;
  ladder.ladder = {10, 20, 40};
  for (const char* file : {"bunny.off", "cow.off", "spot.obj", "cheburashka.off", "elephant.obj", "decimated-max.obj",
                           "gastruloid.ply", "ellipsoid.tif"}) {
    if (wanted(file)) try_fit(options, file, ladder);
  }
  GeometryFitSettings cloud;
  cloud.model.kind = ModelKind::spline;
  cloud.size = {24, 24};
  for (const char* file : {"bunny16k.pts", "Horse_DERIVED.xyz", "cactus.pts", "chameleon4k.pts", "bun0.pcd"}) {
    if (wanted(file)) try_fit(options, file, cloud);
  }
  GeometryFitSettings normal;
  normal.detail = 3;
  for (const char* file : {"bunny.off", "spot.obj", "decimated-max.obj"}) {
    if (wanted(file)) try_fit(options, file, normal);
  }
  GeometryFitSettings quads;
  quads.model.kind = ModelKind::catmull_clark;
  quads.detail = 1;
  for (const char* file :
       {"bunny.off", "spot.obj", "knot.ply", "rocker-arm.obj", "3holes.off", "Rocker_arm_DERIVED.xyz"}) {
    if (wanted(file)) try_fit(options, file, quads);
  }
}

}  // namespace pellicle::bench
