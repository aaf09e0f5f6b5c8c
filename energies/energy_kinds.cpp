#include "pellicle/energies/energy_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>

#include "pellicle/base/errors.h"
#include "pellicle/energies/bending.h"
#include "pellicle/energies/body.h"
#include "pellicle/energies/crossing.h"
#include "pellicle/energies/edge.h"
#include "pellicle/energies/flux.h"
#include "pellicle/energies/inflation.h"
#include "pellicle/energies/region.h"
#include "pellicle/energies/spacing.h"
#include "pellicle/energies/springs.h"
#include "pellicle/energies/tension.h"
#include "pellicle/energies/volume.h"

namespace pellicle {

namespace {

constexpr EnergyKind kKinds[] = {
    {.name = "region",
     .kind = "residual",
     .formula = "t = argmin int q ds + 0.02 t^2/R",
     .text = "two levels: line search along each normal (L-BFGS stages: h/A int q dV)",
     .form = {1, make_term<RegionTerm>},
     .as_integral = {8, make_term<RegionIntegralTerm>},
     .traits = {.searches = true}},
    {.name = "body",
     .kind = "residual",
     .formula = "t = argmax int (I - (a+b)/2)/(a-b) ds/w - 0.075 (t/w)^2",
     .text = "region for many small bodies: levels of the whole body, profiles end at the neighbours' territories",
     .form = {3, make_term<BodyTerm>},
     .traits = {.for_many = true}},
    {.name = "edge",
     .kind = "residual",
     .formula = "t = int f ds - w + s^2 (k1+k2)/2",
     .text = "sub-voxel place of the edge, robust",
     .form = {2, make_term<EdgeTerm>},
     .traits = {.localises = true}},
    {.name = "crossing",
     .kind = "residual",
     .formula = "first s with I < low + share (top - low)",
     .text = "first crossing from inside, for the brain in T1",
     .form = {4, make_term<CrossingTerm>},
     .least_reach_mm = CrossingSettings{}.depth},
    {.name = "bending",
     .kind = "residual",
     .formula = "1/(4 pi) int |trace-free Hessian|^2",
     .text = "smoothness; zero for ellipsoids",
     .constant = bending_rows,
     .coarse = true,
     .traits = {.smooths = true}},
    {.name = "tension",
     .kind = "residual",
     .formula = "1/(8 pi) int |grad x|^2",
     .text = "membrane; pulls together",
     .constant = tension_rows},
    {.name = "spacing",
     .kind = "residual",
     .formula = "sum A_i/A |tangential move|^2 + fold barrier",
     .text = "keeps control points spread and facets unfolded",
     .form = {6, make_term<SpacingTerm>}},
    {.name = "springs",
     .kind = "residual",
     .formula = "mean w (n . (x - y))^2",
     .text = "pulls the nearest place to each expert point; needs --points",
     .form = {5, make_term<SpringsTerm>},
     .traits = {.needs_points = true}},
    {.name = "flux",
     .kind = "scalar",
     .formula = "p h^2 s/(c A) int grad(G_s I) . dA",
     .text = "flux of the smoothed gradient",
     .form = {7, make_term<FluxTerm>}},
    {.name = "volume",
     .kind = "scalar",
     .formula = "r0^2/2 ((V-V0)/(3 V0))^2",
     .text = "prior on the volume; needs --target-volume",
     .form = {9, make_term<VolumeTerm>},
     .traits = {.needs_target_volume = true}},
    {.name = "inflation",
     .kind = "scalar",
     .formula = "-h (V-V0)/A",
     .text = "constant pressure; negative deflates",
     .form = {10, make_term<InflationTerm>},
     .least_weight = -std::numeric_limits<double>::infinity()},
};

constexpr const EnergyKind* kind_of(std::string_view name) {
  for (const EnergyKind& kind : kKinds) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

/// Refused by the compiler when the table has no such row.
consteval const EnergyKind& row(std::string_view name) {
  return *kind_of(name);
}

}  // namespace

std::span<const EnergyKind> energy_kinds() {
  return kKinds;
}

const EnergyKind* find_energy(std::string_view name) {
  return kind_of(name);
}

namespace energy {
constinit const EnergyKind &region = row("region"), &body = row("body"), &edge = row("edge"),
                           &crossing = row("crossing"), &bending = row("bending"), &tension = row("tension"),
                           &spacing = row("spacing"), &springs = row("springs"), &flux = row("flux"),
                           &volume = row("volume"), &inflation = row("inflation");
}  // namespace energy

}  // namespace pellicle
