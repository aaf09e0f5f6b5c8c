#include "pellicle/fit/fit.h"

#include <fmt/format.h>

#include <algorithm>

#include "pellicle/fit/refinement.h"
#include "pellicle/fit/surface_fit.h"

namespace pellicle {

namespace {

// No hypothesis found an edge: the seed itself is handed back, with its status.
FitResult nothing_seen(const Seed& seed, const FitOptions& options) {
  const auto* sphere = std::get_if<SeedSphere>(&seed);
  const SurfaceModel model = start_model(options.model);
  FitResult result{sphere != nullptr
                       ? Surface{model, on_ellipsoid(model, sphere->center, sphere->radius * Mat3::Identity())}
                       : std::get<Surface>(seed),
                   {}};
  result.summary.reason = "no edge in a quarter of the directions around the seed";
  return result;
}

// A seed surface is kept as it is when the fit from it fails, does not converge, sees no edge, or ends on edges that
// are weak and weaker than those at the seed. None: the refined surface stands.
std::optional<Attempt> seed_as_given(SurfaceFit& fit, const std::vector<Seed>& seeds, const Attempt& refined) {
  const auto* surface = std::get_if<Surface>(&seeds.front());
  if (seeds.size() > 1 || surface == nullptr || refined.now.certain) return std::nullopt;
  FitStatus status = refined.now.status;
  if (status == FitStatus::ok) status = verdict_on(refined, std::nullopt, -1.0).status;
  if (status == FitStatus::ok) return std::nullopt;
  Attempt given(refined.start);
  given.now.surface = *surface;
  given.now.reading.name = "seed surface, as given";
  given.judgement = fit.judge(given.now);
  if (status == FitStatus::doubtful && refined.judgement.credit >= given.judgement.credit) return std::nullopt;
  return given;
}

/// The attempts of a fit, and which of them ranks first.
struct Attempts {
  std::vector<Attempt> all;
  std::size_t best = 0;
  bool decided() const { return !all.empty() && is_decisive(all[best]); }

  // Until one of them is decisive.
  void add(std::vector<Candidate> candidates, SurfaceFit& fit, const Observer& observer) {
    for (Candidate& candidate : candidates) {
      if (decided()) return;
      const auto count = static_cast<double>(all.size());
      observer.tell_progress(0.5 * count / (count + 3.0), candidate.reading.name);
      all.emplace_back(std::move(candidate));
      fit.try_out(all.back());
      if (ranks_before(all.back(), all[best])) best = all.size() - 1;
    }
  }
};

}  // namespace

FitResult fit_surface(const FitInput& input, const FitOptions& options, const Observer& observer) {
  SurfaceFit fit(input.image, input.points, options, observer);
  const std::vector<Seed>& seeds = input.seeds;
  const auto prefix = [&](std::size_t s) { return seeds.size() > 1 ? fmt::format("seed {}: ", s + 1) : std::string(); };
  Attempts attempts;
  for (std::size_t s = 0; s < seeds.size() && !attempts.decided(); ++s) {
    attempts.add(fit.propose(seeds[s], prefix(s)), fit, observer);
  }
  for (std::size_t s = 0; s < seeds.size() && !attempts.decided(); ++s) {
    attempts.add(fit.propose_similar(seeds[s], prefix(s)), fit, observer);
  }
  if (attempts.all.empty()) return nothing_seen(seeds.front(), options);
  Attempt& best = attempts.all[attempts.best];
  observer.tell_progress(0.5, "refining " + best.now.reading.name);
  // Margins compare like with like, before the best is refined; should refining take its lead away, that counts as
  // well.
  const double lead = margin_of(attempts.all, attempts.best);
  refine_by_prediction(fit, best);
  const double refined_lead = margin_of(attempts.all, attempts.best);
  const double margin = lead < 0.0 || refined_lead < 0.0 ? std::max(lead, refined_lead) : std::min(lead, refined_lead);
  std::optional<Attempt> given = seed_as_given(fit, seeds, best);
  if (!given) return result_of(attempts.all, attempts.best, margin);
  const std::string failure = result_of(attempts.all, attempts.best, margin).summary.reason;
  attempts.all.push_back(std::move(*given));
  const std::size_t last = attempts.all.size() - 1;
  FitResult result = result_of(attempts.all, last, margin_of(attempts.all, last));
  result.summary.status = FitStatus::doubtful;
  result.summary.reason = "the seed is kept because the fit from it failed: " + failure;
  return result;
}

}  // namespace pellicle
