#pragma once
/// Several shapes side by side in one picture, all in the same view and at the same scale.

#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/picture/canvas.h"

namespace pellicle {

struct SheetPanel {
  const TriangleMesh* mesh = nullptr;  ///< LPS mm; not owned
  std::string caption;
};

/// Rows of shaded views under a title, each shape in the middle of its panel. At most 40 panels: of more, every n-th
/// and the last. Deterministic.
Canvas contact_sheet(const std::vector<SheetPanel>& all, const std::string& title);

/// `text`, or "..." and its end where it is wider than `width` pixels: the end of a long name tells files apart.
std::string fitting_text(const std::string& text, int scale, int width);

}  // namespace pellicle
