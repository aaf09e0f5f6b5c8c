#include "pellicle/fit/surface_fit.h"

#include <fmt/format.h>

#include <utility>

#include "pellicle/base/errors.h"
#include "pellicle/fit/hypotheses.h"
#include "pellicle/fit/refinement.h"

namespace pellicle {

SurfaceFit::SurfaceFit(const Image<float>& image, FitSettings settings, Observer observer)
    : image_(image), settings_(std::move(settings)), observer_(std::move(observer)) {
  settings_.validate();
}

std::vector<Candidate> SurfaceFit::propose(const Seed& seed, const std::string& name_prefix) {
  const auto* surface = std::get_if<Surface>(&seed);
  if (surface != nullptr && !is_closed(surface->model)) {
    throw UsageError(fmt::format("seed surface ({}): is open and encloses no object; start from a closed one",
                                 model_name(surface->model)));
  }
  return hypotheses_for(image_, seed, settings_, name_prefix, observer_);
}

std::vector<Candidate> SurfaceFit::propose_similar(const Seed& seed, const std::string& name_prefix) {
  const auto* ball = std::get_if<SeedSphere>(&seed);
  const bool wanted =
      settings_.similarity && settings_.start_rule == StartRule::automatic && settings_.boundary != Boundary::ridge;
  if (!wanted || ball == nullptr) return {};
  return similarity_hypotheses(image_, *ball, settings_, name_prefix);
}

StageOutcome SurfaceFit::advance(Candidate& candidate, const StageRequest& request) {
  return run_stage(context(), request, candidate);
}

Judgement SurfaceFit::judge(const Candidate& candidate) {
  return pellicle::judge(context(), candidate);
}

void SurfaceFit::try_out(Attempt& attempt) {
  for (std::size_t s = 0; s < attempt.now.compare_after && attempt.now.status == FitStatus::ok; ++s) {
    StageRequest request{.stage = attempt.now.stages[s]};
    if (s == 0) request.first_reach_mm = attempt.now.first_reach_mm;
    attempt.stages.push_back(advance(attempt.now, request).summary);
  }
  attempt.judgement = judge(attempt.now);
}

void SurfaceFit::refine(Attempt& attempt) {
  refine_by_prediction(*this, attempt);
  attempt.judgement = judge(attempt.now);
}

void SurfaceFit::set_points(ExpertPoints points) {
  settings_.points = std::move(points);
  settings_.validate();
}

}  // namespace pellicle
