#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "command_flags.h"
#include "commands.h"
#include "pellicle/output/fit_files.h"

namespace pellicle::cli {

namespace {

int run_fit(const GeometryFitSettings& settings, const std::vector<std::string>& command_line, Console& console) {
  const GeometryFitResult result = fit_to_files(settings, {.command_line = command_line}, console.observer());
  const double diameter = result.input.data.diameter;
  std::cout << heading_of_fits() << "\n";
  if (!result.settings.ladder.empty()) {
    for (const auto& fitted : result.fit.sizes.tried) std::cout << line_of(fitted, diameter) << "\n";
  } else {
    std::cout << line_of(result.fit.sizes.best(), diameter) << "\n";
  }
  const FittedSurface& chosen = result.fit.sizes.best();
  if (chosen.status != SizeStatus::ok)
    console.warn(fmt::format("{} ({}): {}", to_string(chosen.status), chosen.name, chosen.reason));
  return result.exit_code();
}

}  // namespace

Run add_fit(CLI::App& app, const std::vector<std::string>& command_line) {
  app.footer(
      "Coordinates are LPS mm as they stand in the file. A table on stdout, one line per fit: residuals of the data to "
      "the "
      "surface.\n"
      "Exit code 3: the surface cuts itself or misses the tolerance (files are written, the report says why).\n"
      "Example: pellicle fit -i bunny.ply -o out --model spline --ladder 10,20,40");
  return settings_command<GeometryFitSettings>(app, geometry_fit_table(),
                                               [command_line](const GeometryFitSettings& settings, Console& console) {
                                                 return run_fit(settings, command_line, console);
                                               });
}

}  // namespace pellicle::cli
