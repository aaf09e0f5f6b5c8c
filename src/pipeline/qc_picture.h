#pragma once
/// The picture that lets a person judge a result at a glance.

#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/pipeline/segment.h"
#include "pellicle/pipeline/slice_view.h"

namespace pellicle {

/// A row of a picture.
struct PictureRow {
  std::string title;
  TriangleMesh mesh;  ///< LPS mm
  std::vector<SliceLabel> labels = {};
};

/// For each row: axial, coronal and sagittal slices through its centre with the true cut of the surface, and a
/// shaded view of the surface. Slices follow the voxels (nearest anatomical plane) and are shown as radiologists do:
/// the patient's right on the left of the picture, front up (axial) or to the left (sagittal).
/// Deterministic. \throws CannotCreate, IoError.
void write_pictures(const std::filesystem::path& path, const Image<float>& image, const std::vector<PictureRow>& rows);

/// The same of fitted objects, with volume and status.
void write_qc_picture(const std::filesystem::path& path, const Image<float>& image,
                      const std::vector<ObjectResult>& objects, const std::string& name);

/// Many objects in one row: slices through the middle of the stack with every contour and its label, and how many there
/// are. \pre each has a shape (segment_many.h).
void write_overview(const std::filesystem::path& path, const Image<float>& image,
                    const std::vector<ObjectResult>& objects, const std::string& name);

}  // namespace pellicle
