// One object, no seed: is the first candidate the object, and does the program know when it is not?

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "click.h"
#include "phantom_cases.h"
#include "sections.h"

namespace pellicle::bench {

void unseeded_table(const Options& options) {
  const int draws = std::max(1, options.seeds / 4);
  fmt::print(
      "\n## One object, no seed\n\nThe phantoms above, {} noise draws a case, --model {}. The object is found when "
      "Dice "
      "is 0.8 or more. Told: the status of a miss is not ok, so that the exit code is 3.\n\n",
      draws, model_name(start_model(options.model)));
  fmt::print(
      "| shape | case | found | Dice worst | misses told | status of misses | found but not ok | seconds "
      "|\n|---|---|---|---|---|---|---|---|\n");
  int all = 0, all_found = 0, all_told = 0, all_doubted = 0;
  for (const std::string shape : kShapes) {
    if (!options.only.empty() && options.only != shape) continue;
    for (std::size_t v = 0; v < kVariants.size(); ++v) {
      int found = 0, told = 0, doubted = 0;
      double worst = 1.0, seconds = 0.0;
      std::string statuses;
      for (int draw = 0; draw < draws; ++draw) {
        PhantomSettings s = phantom_case(shape, v);
        s.seed += 1000 * static_cast<std::uint64_t>(draw);
        const Phantom phantom = make_phantom(s);
        FitOptions settings;
        settings.model = options.model;
        const double begin = seconds_now();
        std::vector<Seed> seeds;
        for (const SeedSphere& candidate : find_candidates(phantom.image)) seeds.emplace_back(candidate);
        const FitResult fit = fit_surface({phantom.image, seeds}, settings);
        seconds += (seconds_now() - begin) / draws;
        const double dice = overlap_with(phantom.truth, fit.surface).dice;
        worst = std::min(worst, dice);
        const bool ok = fit.summary.status == FitStatus::ok;
        if (dice >= 0.8) {
          ++found;
          doubted += ok ? 0 : 1;
        } else {
          told += ok ? 0 : 1;
          statuses += (statuses.empty() ? "" : ", ") + to_string(fit.summary.status);
        }
      }
      fmt::print("| {} | {} | {}/{} | {:.3f} | {}/{} | {} | {} | {:.2f} |\n", shape, kVariants[v], found, draws, worst,
                 told, draws - found, statuses, doubted, seconds);
      std::fflush(stdout);
      all += draws;
      all_found += found;
      all_told += told;
      all_doubted += doubted;
    }
  }
  if (all > 0) {
    fmt::print("| **all** | | {}/{} ({:.0f} %) | | {}/{} | | {} | |\n", all_found, all, 100.0 * all_found / all,
               all_told, all - all_found, all_doubted);
  }
}

}  // namespace pellicle::bench
