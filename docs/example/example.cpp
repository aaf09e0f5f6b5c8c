// Segments an array made in memory: no file is read or written.
#include <pellicle/job/segment.h>

#include <iostream>

int main() {
  pellicle::ImageGrid grid;
  grid.size = {64, 64, 48};
  grid.spacing = {1.0, 1.0, 1.5};  // mm
  pellicle::Image<float> image(grid);
  const pellicle::Vec3 centre = grid.world_from_index({32, 30, 24});
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {  // a bright ellipsoid with half axes of 20, 14 and 14 mm
        const pellicle::Vec3 x = grid.world_from_index(pellicle::Vec3(i, j, k)) - centre;
        image.at(i, j, k) = x.cwiseQuotient(pellicle::Vec3(20, 14, 14)).norm() < 1.0 ? 100.0F : 20.0F;
      }
    }
  }
  const pellicle::Segmentation found = pellicle::segment(image, {{.candidates = {pellicle::SeedSphere{centre, 8.0}}}});
  for (const pellicle::ObjectResult& object : found.objects) {
    std::cout << object.label << " " << object.volume_surface_ml << " ml " << to_string(object.fit.status) << "\n";
  }
  return found.all_ok() ? 0 : 1;
}
