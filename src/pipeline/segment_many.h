#pragma once
/// The parts of `pellicle segment` that are particular to many objects of one kind.

#include <string>
#include <vector>

#include "pellicle/fit/many.h"
#include "pellicle/pipeline/seeding.h"
#include "pellicle/pipeline/segment.h"

namespace pellicle {

ManySettings many_settings(const SegmentSettings& settings);

/// Finds the objects or, when the user gave seeds, fits one to each; fills result.objects and result.many.
void fit_many_objects(const std::vector<ObjectSeed>& seeds, Image<float> image, const RunContext& context,
                      SegmentResult& result);

/// Meshes, measures and voxel labels of all objects. Meshes are coarser than those of one object: facets of about a
/// voxel, at most 4000. \param fraction filled when it has the labels' grid.
Image<std::uint16_t> measure_many(SegmentResult& result, const ImageGrid& grid, Image<float>& fraction);

/// All objects' meshes as one.
TriangleMesh merged_mesh(const std::vector<ObjectResult>& objects);

/// Signed distance to the nearest of all surfaces, mm, negative inside.
Image<float> distance_to_all(const std::vector<ObjectResult>& objects, const ImageGrid& grid);

/// STEM_dseg.tsv of many objects: a line an object, columns as docs/nuclei.md says.
std::string many_table(const std::vector<ObjectResult>& objects);

}  // namespace pellicle
