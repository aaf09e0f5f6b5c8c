#pragma once
/// One slice of a volume with the cut of a surface, as a radiologist looks at it.

#include <array>
#include <string>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/picture/canvas.h"

namespace pellicle {

/// The anatomical plane that a slice is nearest to.
enum class SlicePlane { axial, coronal, sagittal };

/// Which index axes run along the picture and which way; signs +1 or -1.
struct SliceAxes {
  int right = 0, down = 1, through = 2;  ///< index axes
  int right_sign = 1, down_sign = 1;
  char left_letter = 'R', right_letter = 'L', up_letter = 'A', down_letter = 'P';
};
SliceAxes slice_axes(const ImageGrid& grid, SlicePlane plane);

/// Intensities shown as black and white.
struct Window {
  double black = 0.0, white = 1.0;
};
/// 0.5th and 99.5th percentile of the volume; never empty.
Window robust_window(const Image<float>& image);

/// Pieces of the cut of `mesh` (vertices in index coordinates) by the plane index[axis] = position.
std::vector<std::array<Vec3, 2>> cut_by_plane(const TriangleMesh& mesh_in_index, int axis, double position);

/// What is written over an object that a slice cuts.
struct SliceLabel {
  std::string text;
  Vec3 centre{0, 0, 0};  ///< LPS mm
  double radius = 0.0;   ///< mm, of a ball of the object's volume
};

/// \param mesh_in_index the surface in index coordinates; the slice goes through the middle of its box.
/// \param labels of the objects that the mesh is made of; those with room for it get it.
Canvas draw_slice(const Image<float>& image, const Window& window, const TriangleMesh& mesh_in_index, SlicePlane plane,
                  int size, const std::vector<SliceLabel>& labels = {});

}  // namespace pellicle
