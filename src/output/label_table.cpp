#include "pellicle/output/label_table.h"

#include <fmt/format.h>

namespace pellicle {

namespace {

std::string many_table(const std::vector<ObjectResult>& objects) {
  std::string text =
      "index\tlabel\tname\tvolume_ml\tstatus\tx_mm\ty_mm\tz_mm\tvolume_surface_ml\tvolume_visible_ml\tvisible_share\t"
      "area_mm2\tsphericity\telongation\tcontrast\tsupport\ttouches_border\n";
  for (const ObjectResult& o : objects) {
    const ObjectShape& s = *o.shape;
    text += fmt::format(
        "{}\t{}\t{}\t{:.6g}\t{}\t{:.6g}\t{:.6g}\t{:.6g}\t{:.6g}\t{:.6g}\t{:.4f}\t{:.6g}\t{:.4f}\t{:.4f}\t{:.6g}\t{:.4f}"
        "\t{}\n",
        o.label, o.label, o.name, o.volume_mask_ml, to_string(o.fit.status), s.centre[0], s.centre[1], s.centre[2],
        o.volume_surface_ml, o.volume_partial_ml, s.visible, o.area_mm2, s.sphericity, s.elongation,
        o.fit.evidence.contrast, s.support, o.touches_border ? 1 : 0);
  }
  return text;
}

}  // namespace

std::string label_table(const std::vector<ObjectResult>& objects) {
  if (objects.empty() || objects.front().shape) return many_table(objects);
  std::string text = "index\tname\tvolume_ml\tstatus\n";
  for (const ObjectResult& object : objects) {
    text += fmt::format("{}\t{}\t{:.6g}\t{}\n", object.label, object.name, object.volume_mask_ml,
                        to_string(object.fit.status));
  }
  return text;
}

}  // namespace pellicle
