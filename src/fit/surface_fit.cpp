#include "pellicle/fit/surface_fit.h"

#include <fmt/format.h>

#include <utility>

#include "pellicle/base/errors.h"
#include "pellicle/fit/hypotheses.h"

namespace pellicle {

SurfaceFit::SurfaceFit(const Image<float>& image, ExpertPoints points, FitOptions options, Observer observer)
    : image_(image), points_(std::move(points)), options_(std::move(options)), observer_(std::move(observer)) {
  pellicle::validate(points_);
  options_.validate(!points_.points.empty());
}

std::vector<Candidate> SurfaceFit::propose(const Seed& seed, const std::string& name_prefix) {
  const auto* surface = std::get_if<Surface>(&seed);
  if (surface != nullptr && !is_closed(surface->model)) {
    throw UsageError(fmt::format("seed surface ({}): is open and encloses no object; start from a closed one",
                                 model_name(surface->model)));
  }
  return hypotheses_for(image_, seed, options_, points_, name_prefix, observer_);
}

std::vector<Candidate> SurfaceFit::propose_similar(const Seed& seed, const std::string& name_prefix) {
  const auto* ball = std::get_if<SeedSphere>(&seed);
  if (ball == nullptr) return {};
  const std::optional<PlanLine> line = plan(StartKind::ball).similar;
  if (!line) return {};
  return similarity_hypotheses(image_, *ball, options_, *line, name_prefix);
}

StageOutcome SurfaceFit::advance(Candidate& candidate, const StageRequest& request) {
  StageRequest traced = request;
  traced.trace_every = options_.trace_every;
  return run_stage(context(), traced, candidate);
}

Judgement SurfaceFit::judge(const Candidate& candidate) {
  return pellicle::judge(context(), candidate, options_.boundary);
}

void SurfaceFit::try_out(Attempt& attempt) {
  for (std::size_t s = 0; s < attempt.now.line.compare_after && attempt.now.status == FitStatus::ok; ++s) {
    StageRequest request{.stage = attempt.now.line.stages[s]};
    if (s == 0) request.first_reach_mm = attempt.now.first_reach_mm;
    attempt.stages.push_back(advance(attempt.now, request).summary);
    attempt.last = {.stage = request.stage};
  }
  attempt.judgement = judge(attempt.now);
}

void SurfaceFit::set_points(ExpertPoints points) {
  pellicle::validate(points);
  options_.validate(!points.points.empty());
  points_ = std::move(points);
}

}  // namespace pellicle
