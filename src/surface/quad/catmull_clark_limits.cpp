#include "pellicle/surface/quad/internal/catmull_clark_limits.h"

#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include "pellicle/base/errors.h"

namespace pellicle {

namespace far = OpenSubdiv::Far;

struct CatmullClarkLimits::Tables {
  std::unique_ptr<far::TopologyRefiner> refiner;
  std::unique_ptr<const far::PatchTable> patches;
  std::unique_ptr<const far::StencilTableReal<double>> stencils;
};

CatmullClarkLimits::CatmullClarkLimits(const QuadTopology& topology, int isolation, LimitCap cap)
    : tables_(std::make_unique<Tables>()) {
  std::vector<int> corners, counts(topology.quads.size(), 4);
  corners.reserve(4 * topology.quads.size());
  for (const Quad& quad : topology.quads) corners.insert(corners.end(), quad.begin(), quad.end());
  far::TopologyDescriptor descriptor;
  descriptor.numVertices = topology.vertex_count();
  descriptor.numFaces = static_cast<int>(topology.quads.size());
  descriptor.numVertsPerFace = counts.data();
  descriptor.vertIndicesPerFace = corners.data();
  using OpenSubdiv::Sdc::Options;
  Options options;
  options.SetVtxBoundaryInterpolation(Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  using Factory = far::TopologyRefinerFactory<far::TopologyDescriptor>;
  tables_->refiner.reset(Factory::Create(descriptor, Factory::Options(OpenSubdiv::Sdc::SCHEME_CATMARK, options)));
  if (!tables_->refiner) throw BadData("quad mesh (all): OpenSubdiv cannot subdivide it");

  using PatchOptions = far::PatchTableFactory::Options;
  PatchOptions patch_options(static_cast<unsigned>(isolation));
  patch_options.SetEndCapType(cap == LimitCap::gregory ? PatchOptions::ENDCAP_GREGORY_BASIS
                                                       : PatchOptions::ENDCAP_BSPLINE_BASIS);
  patch_options.SetPatchPrecision<double>();
  tables_->refiner->RefineAdaptive(patch_options.GetRefineAdaptiveOptions());
  tables_->patches.reset(far::PatchTableFactory::Create(*tables_->refiner, patch_options));

  using Stencils = far::StencilTableFactoryReal<double>;
  Stencils::Options stencil_options;
  stencil_options.generateControlVerts = true;
  stencil_options.generateIntermediateLevels = true;
  stencil_options.generateOffsets = true;
  tables_->stencils.reset(Stencils::Create(*tables_->refiner, stencil_options));
  const auto* const local = tables_->patches->GetLocalPointStencilTable<double>();
  if (local == nullptr) return;
  const far::StencilTableReal<double>* const both =
      Stencils::AppendLocalPointStencilTable(*tables_->refiner, tables_->stencils.get(), local);
  if (both != nullptr) tables_->stencils.reset(both);
}

CatmullClarkLimits::~CatmullClarkLimits() = default;

LimitWeights CatmullClarkLimits::at(const std::vector<QuadPlace>& places, bool second_derivatives) const {
  using Limits = far::LimitStencilTableFactoryReal<double>;
  Limits::LocationArrayVec locations(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    locations[i].ptexIdx = places[i].quad;  // of quads alone, Ptex faces are the quads
    locations[i].numLocations = 1;
    locations[i].s = &places[i].s;
    locations[i].t = &places[i].t;
  }
  LimitWeights result;
  if (places.empty()) return result;
  Limits::Options options;
  options.generate1stDerivatives = true;
  options.generate2ndDerivatives = second_derivatives;
  const std::unique_ptr<const far::LimitStencilTableReal<double>> table(
      Limits::Create(*tables_->refiner, locations, tables_->stencils.get(), tables_->patches.get(), options));
  if (!table || static_cast<std::size_t>(table->GetNumStencils()) != places.size()) {
    throw BadData("quad mesh (all): OpenSubdiv does not find every place of the surface");
  }
  result.start.reserve(places.size() + 1);
  for (const int size : table->GetSizes()) result.start.push_back(result.start.back() + size);
  result.index = table->GetControlIndices();
  result.x = table->GetWeights();
  result.s = table->GetDuWeights();
  result.t = table->GetDvWeights();
  if (second_derivatives) {
    result.ss = table->GetDuuWeights();
    result.st = table->GetDuvWeights();
    result.tt = table->GetDvvWeights();
  }
  return result;
}

std::vector<QuadPiece> CatmullClarkLimits::pieces() const {
  std::vector<QuadPiece> result;
  const far::PatchTable& table = *tables_->patches;
  result.reserve(static_cast<std::size_t>(table.GetNumPatchesTotal()));
  for (int array = 0; array < table.GetNumPatchArrays(); ++array) {
    for (int patch = 0; patch < table.GetNumPatches(array); ++patch) {
      const far::PatchParam param = table.GetPatchParam(array, patch);
      double s = 0.0, t = 0.0;
      param.Unnormalize(s, t);
      result.push_back({param.GetFaceId(), s, t, static_cast<double>(param.GetParamFraction())});
    }
  }
  return result;
}

}  // namespace pellicle
