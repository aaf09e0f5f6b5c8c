#include "pellicle/fit/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/fit/evidence.h"
#include "pellicle/fit/expert_points.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

// Whether what lies behind the edge is like the object again.
bool looks_like_membrane(Boundary boundary, const Reading& reading, const Evidence& evidence) {
  return boundary == Boundary::automatic && !reading.ridge && !reading.tissue && evidence.returning_share > 0.5;
}

// By how much the best reading must be ahead of one that found another volume. Among ranges of "similar to the seed"
// the evidence of a wrong one was seen 1.4 times that of the right one (a tumour in T1), so more is asked there.
constexpr double kMargin = 1.1, kSimilarMargin = 1.5;
// A result that shares less with its ball seed is likely another object beside it. (Of 40 hippocampi from a ball of 5
// mm those of Dice below 0.05 share 6 to 31 %, the others 43 % or more but for one.)
constexpr double kLeastSeedShare = 0.25;

bool still_moves(const Attempt& attempt) {
  if (attempt.stages.empty()) return false;
  const StageSummary& last = attempt.stages.back();
  return last.termination == Termination::step_limit && last.last_move_mm > 0.5;
}

// Of a ball that is where the object was said to be and of the surface that was found.
double shared_volume(const SeedSphere& ball, const Surface& surface) {
  constexpr int kVoxels = 24;
  ImageGrid grid;
  grid.size = {kVoxels, kVoxels, kVoxels};
  grid.spacing = Vec3::Constant(2.0 * ball.radius / kVoxels);
  grid.origin_in_world = ball.center - Vec3::Constant(ball.radius) + 0.5 * grid.spacing;
  const Image<std::uint8_t> mask = rasterize_mask(tessellate(surface, 3), grid);
  const double radius = 0.5 * kVoxels, middle = radius - 0.5;
  int shared = 0;
  for (int k = 0; k < kVoxels; ++k) {
    for (int j = 0; j < kVoxels; ++j) {
      for (int i = 0; i < kVoxels; ++i) {
        const bool in_ball = (Vec3(i, j, k) - Vec3::Constant(middle)).norm() <= radius;
        shared += in_ball && mask.voxels[grid.offset(i, j, k)] != 0 ? 1 : 0;
      }
    }
  }
  return shared * grid.spacing.prod();
}

double seed_share(const SeedSphere& ball, const Attempt& attempt) {
  const double of_ball = 4.0 / 3.0 * std::numbers::pi * std::pow(ball.radius, 3);
  const double smaller = std::min(of_ball, std::abs(attempt.judgement.volume));
  return smaller > 0.0 ? std::min(1.0, shared_volume(ball, attempt.now.surface) / smaller) : 0.0;
}

}  // namespace

Judgement judge(const StageContext& context, const Candidate& candidate, Boundary boundary) {
  Judgement j;
  j.evidence = evidence_of(context.image, candidate.surface, candidate.reading.ridge, context.geometry);
  j.volume = volume_with_normals(tessellate(candidate.surface, 3));
  j.credit = j.evidence.score;
  // The near side of a membrane, unless a step was asked for.
  if (looks_like_membrane(boundary, candidate.reading, j.evidence) && j.credit > 0.0) j.credit *= 0.25;
  // A seed says where the object is and, roughly, how large. Half the credit at three times its radius or a third of
  // it.
  const double radius = std::cbrt(3.0 * std::abs(j.volume) / (4.0 * std::numbers::pi));
  if (candidate.seed_radius > 0.0 && j.credit > 0.0) {
    const double ratio = radius / (3.0 * candidate.seed_radius), inverse = candidate.seed_radius / (3.0 * radius);
    j.credit /= 1.0 + std::pow(ratio, 4) + std::pow(inverse, 4);
  }
  // Points say where the surface is: half the credit where they lie a tenth of the radius off.
  if (!context.points.points.empty()) {
    j.points = distances_to(context.points, candidate.surface, context.image.grid.mean_spacing());
    if (j.credit > 0.0) j.credit /= 1.0 + std::pow(j.points->rms_mm / (0.1 * radius), 2);
  }
  return j;
}

// Thresholds: measured on phantoms, CT and MR (docs/accuracy.md).
Verdict verdict_on(const Attempt& attempt, const std::optional<double>& seed_share, double margin) {
  const Evidence& e = attempt.judgement.evidence;
  const bool tissue = attempt.now.reading.tissue.has_value();
  if (still_moves(attempt)) {
    return {FitStatus::not_converged,
            fmt::format("still moving by {:.2f} mm a step at the step limit", attempt.stages.back().last_move_mm)};
  }
  if (e.contrast <= 0.0 || (!tissue && e.score < 0.1)) {
    return {
        FitStatus::no_contrast,
        fmt::format("no evidence of an edge along a quarter of the surface (evidence {:.2f}, 0.3 is wanted)", e.score)};
  }
  if (e.weak_share > 0.25 || (!tissue && e.score < 0.3)) {
    return {FitStatus::doubtful,
            fmt::format("weak evidence: {:.2f} (0.3 is wanted), {:.0f} % of the surface without an edge", e.score,
                        100.0 * e.weak_share)};
  }
  if (seed_share && *seed_share < kLeastSeedShare) {
    return {
        FitStatus::doubtful,
        fmt::format("the surface left its seed: they share {:.0f} % of the smaller one's volume", 100.0 * *seed_share)};
  }
  if (margin > 0.0 && margin < (attempt.now.reading.similarity ? kSimilarMargin : kMargin)) {
    return {
        FitStatus::ambiguous,
        fmt::format("another hypothesis of another size has nearly the same evidence (margin {:.2f}); give a seed or "
                    "settings",
                    margin)};
  }
  return {};
}

bool ranks_before(const Attempt& a, const Attempt& b) {
  const bool a_ok = a.now.status == FitStatus::ok, b_ok = b.now.status == FitStatus::ok;
  return a_ok != b_ok ? a_ok : a.judgement.credit > b.judgement.credit;
}

bool is_decisive(const Attempt& attempt) {
  // Of a ladder of ranges every one is tried: too narrow a range has good evidence too where there is little noise.
  if (attempt.now.status != FitStatus::ok || attempt.now.reading.similarity) return false;
  const Evidence& e = attempt.judgement.evidence;
  return attempt.now.certain ||
         (attempt.judgement.credit > 0.25 && e.score > 3.0 && e.weak_share < 0.05 && e.returning_share < 0.5);
}

double margin_of(const std::vector<Attempt>& attempts, std::size_t best) {
  double runner_up = -1.0;
  bool found = false;
  const Judgement& first = attempts[best].judgement;
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    const double ratio = attempts[i].judgement.volume / first.volume;
    if (i == best || attempts[i].now.status != FitStatus::ok || (ratio > 0.8 && ratio < 1.25)) continue;
    runner_up = std::max(runner_up, attempts[i].judgement.credit);
    found = true;
  }
  if (!found) return -1.0;
  return runner_up > 0.0 ? std::min(1e3, first.credit / runner_up) : 1e3;
}

FitResult result_of(const std::vector<Attempt>& attempts, std::size_t best, double margin) {
  const Attempt& chosen = attempts[best];
  FitResult result{chosen.now.surface, {}, chosen.now.trace};
  FitSummary& summary = result.summary;
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    const Attempt& a = attempts[i];
    summary.hypotheses.push_back(
        {a.now.reading.name, a.now.status, a.judgement.evidence.score, 1e-3 * a.judgement.volume, i == best});
  }
  summary.margin = margin;
  summary.status = chosen.now.status;
  summary.reason = chosen.now.reason;
  summary.stages = chosen.stages;
  summary.evidence = chosen.judgement.evidence;
  const Reading& reading = chosen.now.reading;
  summary.boundary = reading.ridge ? Boundary::ridge : Boundary::step;
  summary.polarity = reading.similarity ? Polarity::automatic : reading.sign > 0.0 ? Polarity::bright : Polarity::dark;
  summary.level_inside = chosen.now.levels.inside;
  summary.level_outside = chosen.now.levels.outside;
  summary.points = chosen.judgement.points;
  if (summary.status != FitStatus::ok) return result;
  if (chosen.now.ball) summary.seed_share = seed_share(*chosen.now.ball, chosen);
  const Verdict verdict = verdict_on(chosen, summary.seed_share, margin);
  summary.status = verdict.status;
  if (verdict.status != FitStatus::ok) summary.reason = verdict.reason;
  return result;
}

}  // namespace pellicle
