#include "pellicle/output/morph_files.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "command_flags.h"
#include "commands.h"

namespace pellicle::cli {

namespace {

int run_morph(const MorphSettings& settings, const std::vector<std::string>& command_line, Console& console) {
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

}  // namespace

Run add_morph(CLI::App& app, const std::vector<std::string>& command_line) {
  app.footer(
      "Writes STEM_morph-001_surface.ply, STEM_morph-001_model.json, ..., STEM_morph.tsv, STEM_morph.png and\n"
      "STEM_morph.json. Prints one line per shape: step, tau, volume in ml, area in mm^2, status.\n"
      "Example: pellicle morph before_model.json after_model.json -o out --steps 7 --space sphere --from -0.5 --to "
      "1.5");
  return settings_command<MorphSettings>(app, morph_table(),
                                         [command_line](const MorphSettings& settings, Console& console) {
                                           return run_morph(settings, command_line, console);
                                         });
}

}  // namespace pellicle::cli
