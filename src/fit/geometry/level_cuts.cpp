// A level where its surface cuts itself.
#include <Eigen/Dense>
#include <algorithm>

#include "pellicle/fit/geometry/level_fit.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

constexpr int kHoldBacks = 6;
constexpr double kStiffening = 3.0, kMostStiffening = 1000.0;  ///< of a patch that folds, a step and at most
constexpr double kLoosening = 0.7;                             ///< of a patch that folds no more, a step

}  // namespace

LevelFit::Cuts LevelFit::cuts_of(const Parameters& parameters) const {
  SurfaceSamples samples;
  evaluate(surface_.model, parameters, fine_, false, samples);
  const auto pairs = self_intersections(mesh_of(fine_, samples));
  Cuts cuts;
  cuts.pairs = static_cast<int>(pairs.size());
  std::vector<bool> met(blocks_of(surface_.model).size(), false);
  cuts.patches.assign(fine_.patches.size(), false);
  for (const auto& pair : pairs) {
    for (const int t : pair) {
      const auto& corners = fine_.triangles[static_cast<std::size_t>(t)];
      for (const int v : corners) {
        const auto patch = static_cast<std::size_t>(fine_.patch_of[static_cast<std::size_t>(v)]);
        cuts.patches[patch] = true;
        for (const int b : fine_.patches[patch].blocks) met[static_cast<std::size_t>(b)] = true;
      }
    }
  }
  for (std::size_t b = 0; b < met.size(); ++b) {
    if (met[b]) cuts.blocks.push_back(static_cast<int>(b));
  }
  return cuts;
}

// Where the step made the surface cut itself it is taken back, half and half again, with all blocks that reach there.
void LevelFit::hold_back(const Parameters& before) {
  folding_.assign(layout_.patches.size(), false);
  const Parameters after = surface_.parameters;
  const std::vector<BlockKind> kinds = blocks_of(surface_.model);
  std::vector<double> share(kinds.size(), 1.0);
  for (int attempt = 0; attempt < kHoldBacks; ++attempt) {
    const Cuts cuts = cuts_of(surface_.parameters);
    if (cuts.pairs == 0) return;
    if (attempt == 1 && grows()) folding_ = cuts.patches;  // half a step cuts, too
    for (const int b : cuts.blocks) share[static_cast<std::size_t>(b)] *= attempt < 3 ? 0.5 : 0.0;
    for (std::size_t b = 0; b < kinds.size(); ++b) {
      Eigen::Map<const Vec3> from(before.data() + 3 * b), to(after.data() + 3 * b);
      Eigen::Map<Vec3> out(surface_.parameters.data() + 3 * b);
      out = from + share[b] * (to - from);
      if (kinds[b] == BlockKind::unit_normal) out.normalize();
    }
  }
  if (cuts_of(surface_.parameters).pairs > 0) surface_.parameters = before;
}

// Patches that a step folds become stiffer, the others as loose again; whether any changed.
bool LevelFit::stiffen_folds() {
  bool changed = false;
  for (std::size_t patch = 0; patch < folding_.size(); ++patch) {
    const double before = stiffening_[patch];
    stiffening_[patch] =
        folding_[patch] ? std::min(kMostStiffening, kStiffening * before) : std::max(1.0, kLoosening * before);
    changed = changed || stiffening_[patch] != before;
  }
  return changed;
}

}  // namespace pellicle
