#include "pellicle/output/morph_files.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "commands.h"
#include "pellicle/base/errors.h"

namespace pellicle::cli {

namespace {

struct MorphFlags {
  MorphSettings settings;
  std::string space = "plane", mesh_format = "ply";
  int density = -1;
  bool density_given = false;
  ConsoleOptions* console = nullptr;
};

int run_morph(const MorphFlags& flags, const std::vector<std::string>& command_line, Console& console) {
  console.configure(*flags.console);
  MorphSettings settings = flags.settings;
  settings.space = morph_space_from_name(flags.space);
  settings.mesh_format = mesh_format_from_name(flags.mesh_format);
  if (flags.density_given) settings.mesh_density = flags.density;
  const MorphResult done = morph_to_files(settings, {.command_line = command_line}, console.observer());
  const Morphing& result = done.morphing;
  for (const auto& [name, points, moved] :
       {std::tuple{"A", result.points_a, result.moved_a_mm}, std::tuple{"B", result.points_b, result.moved_b_mm}}) {
    if (points == result.points) continue;
    console.warn(fmt::format("{} got {} control points instead of {}, which moved its surface by up to {:.3g} mm", name,
                             result.points, points, moved));
  }
  for (std::size_t i = 0; i < result.steps.size(); ++i) {
    const MorphStep& step = result.steps[i];
    const std::string volume = step.volume_ml ? fmt::format("{:.6g}", *step.volume_ml) : "n/a";
    std::cout << fmt::format("{} {:.6g} {} {:.6g} {}\n", i + 1, step.tau, volume, step.area_mm2,
                             to_string(step.status));
  }
  return done.exit_code();
}

void add_output_flags(CLI::App& app, MorphFlags& flags) {
  app.add_option("-o,--output", flags.settings.output, "output folder, created if missing")
      ->type_name("DIR")
      ->required()
      ->group("Outputs");
  app.add_option("--name", flags.settings.name, "file stem; default: A_to_B, by the names of the models")
      ->type_name("STEM")
      ->group("Outputs");
  app.add_option("--mesh-format", flags.mesh_format, "LPS mm; gii: RAS mm")
      ->type_name("ply|stl|obj|vtp|gii")
      ->capture_default_str()
      ->group("Outputs");
  app.add_option("--mesh-density", flags.density,
                 "2^N facets along a control edge; default: about 300 facets around the object")
      ->type_name("N")
      ->group("Outputs");
  app.add_flag("--overwrite", flags.settings.overwrite, "replace files that exist")->group("Outputs");
}

}  // namespace

Run add_morph(CLI::App& app, const std::vector<std::string>& command_line) {
  auto flags = std::make_shared<MorphFlags>();
  app.add_option("A", flags->settings.a, "a saved model, STEM_model.json: tau = 0")->type_name("A.json")->required();
  app.add_option("B", flags->settings.b, "another of the same kind: tau = 1")->type_name("B.json")->required();
  app.add_option("--steps", flags->settings.steps, "shapes, equally spaced in tau; 1: the middle")
      ->type_name("N")
      ->capture_default_str()
      ->group("Path");
  app.add_option("--space", flags->space, "plane: linear; sphere: the great circle of shapes, size and place apart")
      ->type_name("plane|sphere")
      ->capture_default_str()
      ->group("Path");
  app.add_option("--from", flags->settings.from, "tau of the first shape; below 0 or above 1 extrapolates")
      ->type_name("T0")
      ->capture_default_str()
      ->group("Path");
  app.add_option("--to", flags->settings.to, "tau of the last shape")
      ->type_name("T1")
      ->capture_default_str()
      ->group("Path");
  add_output_flags(app, *flags);
  app.add_option("--threads", flags->settings.threads, "threads; 0: all")
      ->type_name("N")
      ->capture_default_str()
      ->group("Run");
  flags->console = add_console_flags(app);
  app.footer(
      "Writes STEM_morph-001_surface.ply, STEM_morph-001_model.json, ..., STEM_morph.tsv, STEM_morph.png and\n"
      "STEM_morph.json. Prints one line a shape: step, tau, volume in ml, area in mm^2, status.\n"
      "Example: pellicle morph before_model.json after_model.json -o out --steps 7 --space sphere --from -0.5 --to "
      "1.5");
  return [flags, command_line, &app](Console& console) {
    flags->density_given = app.count("--mesh-density") > 0;
    return run_morph(*flags, command_line, console);
  };
}

}  // namespace pellicle::cli
