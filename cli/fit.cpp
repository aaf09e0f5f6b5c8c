#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "commands.h"
#include "pellicle/base/errors.h"
#include "pellicle/output/fit_points.h"

namespace pellicle::cli {

namespace {

struct FitFlags {
  GeometryFitSettings settings;
  std::string model = "normal", mesh_format = "ply", tolerance_of = "rms", write, size, ladder;
  ConsoleOptions* console = nullptr;
};

GeometryFitSettings resolved(const FitFlags& flags) {
  GeometryFitSettings settings = flags.settings;
  settings.model.kind = value_of<ModelKind>(flags.model, "--model " + flags.model);
  settings.mesh_format = mesh_format_from_name(flags.mesh_format);
  if (!flags.write.empty()) settings.write = split_commas(flags.write);
  if (flags.tolerance_of == "p95") {
    settings.tolerance_of = ToleranceOf::p95;
  } else if (flags.tolerance_of == "max") {
    settings.tolerance_of = ToleranceOf::max;
  } else if (flags.tolerance_of != "rms") {
    throw UsageError(fmt::format("bad value (--tolerance-of {}): choose one of rms, p95, max", flags.tolerance_of));
  }
  if (!flags.size.empty()) {
    const auto words = split_commas(flags.size);
    if (words.size() != 2)
      throw UsageError(fmt::format("bad value (--size {}): two whole numbers M1,M2 are needed", flags.size));
    settings.size = {integer_of(words[0], "--size " + flags.size), integer_of(words[1], "--size " + flags.size)};
  }
  if (!flags.ladder.empty()) {
    for (const auto& word : split_commas(flags.ladder))
      settings.ladder.push_back(integer_of(word, "--ladder " + flags.ladder));
  }
  return settings;
}

int run_fit(const FitFlags& flags, const std::vector<std::string>& command_line, Console& console) {
  console.configure(*flags.console);
  const GeometryFitSettings settings = resolved(flags);
  const GeometryFitResult result = fit_to_files(settings, {.command_line = command_line}, console.observer());
  const double diameter = result.input.data.diameter;
  std::cout << heading_of_fits() << "\n";
  if (!result.settings.ladder.empty()) {
    for (const auto& fitted : result.tried) std::cout << line_of(fitted, diameter) << "\n";
  } else {
    std::cout << line_of(result.tried[result.chosen], diameter) << "\n";
  }
  const FittedSurface& chosen = result.tried[result.chosen];
  if (chosen.status != "ok") console.warn(fmt::format("{} ({}): {}", chosen.status, chosen.name, chosen.reason));
  return result.exit_code();
}

}  // namespace

Run add_fit(CLI::App& app, const std::vector<std::string>& command_line) {
  auto flags = std::make_shared<FitFlags>();
  GeometryFitSettings& s = flags->settings;
  app.add_option("-i,--input", s.input,
                 "points (.xyz .pts .csv .pcd .ply), mesh (.ply .obj .stl .off .vtp .gii) or mask (.nii.gz ...), "
                 "FILE:LABEL for one label")
      ->type_name("FILE")
      ->required();
  app.add_option("-o,--output", s.output, "folder; created if missing")->type_name("DIR")->required();
  app.add_option("--name", s.name, "file stem; default: the input's name without its extensions")->type_name("STEM");
  app.add_option("--model", flags->model, "normal, spline, catmull-clark or slime")
      ->type_name("NAME")
      ->capture_default_str()
      ->group("Model");
  app.add_option(
         "--detail", s.detail,
         "refinements of the start model; spline: the ladder of 10, 20, 40, 80 control points each way for N = 0, 1, "
         "2, 3; with a tolerance: at most; default: until points that are left out gain no more")
      ->type_name("N")
      ->group("Model");
  app.add_option("--size", flags->size, "spline of M1 x M2 control points")->type_name("M1,M2")->group("Model");
  app.add_option("--ladder", flags->ladder,
                 "spline: one fit of M x M control points each, as a table and a picture STEM_ladder.png")
      ->type_name("M,M,...")
      ->group("Model");
  app.add_option("--tolerance-mm", s.tolerance_mm, "fewest control points whose residual is at most this, mm")
      ->type_name("T")
      ->group("Model");
  app.add_option("--tolerance-percent", s.tolerance_percent, "the same in % of the diameter")
      ->type_name("P")
      ->group("Model");
  app.add_option("--tolerance-of", flags->tolerance_of,
                 "residual that the tolerance is about: rms, p95 or max, data to surface")
      ->type_name("WHICH")
      ->capture_default_str()
      ->group("Model");
  app.add_flag("--open", s.open,
               "catmull-clark: the points are those of an open surface, a bowl, cap or tube; it ends at their rim")
      ->group("Model");
  app.add_option("--smoothness", s.smoothness, "factor of the bending energy")
      ->type_name("F")
      ->capture_default_str()
      ->group("Model");
  app.add_option("--write", flags->write, "of mesh, model, report; default: all")->type_name("LIST")->group("Outputs");
  app.add_option("--mesh-format", flags->mesh_format, "ply, stl, obj, vtp (LPS mm) or gii (RAS mm)")
      ->type_name("FORMAT")
      ->capture_default_str()
      ->group("Outputs");
  app.add_option("--mesh-density", s.mesh_density, "2^N facets along a control edge; default: about 100,000 facets")
      ->type_name("N")
      ->group("Outputs");
  app.add_flag("--overwrite", s.overwrite, "replace files that exist")->group("Outputs");
  app.add_option("--threads", s.threads, "threads; 0: all; the results are the same bytes for every number")
      ->type_name("N")
      ->capture_default_str()
      ->group("Run");
  flags->console = add_console_flags(app);
  app.footer(
      "Coordinates are LPS mm as they stand in the file. A table on stdout, a line a fit: residuals of the data to the "
      "surface.\n"
      "Exit code 3: the surface cuts itself or misses the tolerance (files are written, the report says why).\n"
      "Example: pellicle fit -i bunny.ply -o out --model spline --ladder 10,20,40");
  return [flags, command_line](Console& console) { return run_fit(*flags, command_line, console); };
}

}  // namespace pellicle::cli
