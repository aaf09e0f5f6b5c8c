#pragma once
/// Rows of slices with the contour of a surface beside its shaded view: what lets a person judge a result at a glance.

#include <string>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/picture/slice_view.h"

namespace pellicle {

/// One row of the picture.
struct PictureRow {
  std::string title;
  TriangleMesh mesh;  ///< LPS mm
  std::vector<SliceLabel> labels = {};
};

/// For each row: axial, coronal and sagittal slices through its centre with the true cut of the surface, and a
/// shaded view of the surface. Slices follow the voxels (nearest anatomical plane) and are shown as radiologists do:
/// the patient's right on the left of the picture, front up (axial) or to the left (sagittal).
/// The same input gives the same bytes. Of more than 40 rows the first 40 are drawn.
Canvas draw_slice_rows(const Image<float>& image, const std::vector<PictureRow>& rows);

/// The four views of one surface: three slices, then the shaded view, each `size` pixels wide.
/// \param image none: the shaded view alone.
std::vector<Canvas> views_of(const Image<float>* image, const Window& window, const PictureRow& row, int size);

}  // namespace pellicle
