#include "pellicle/picture/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/parallel.h"
#include "pellicle/picture/shaded_view.h"

namespace pellicle {

namespace {

constexpr int gap = 4, title_height = 34, caption_height = 26;
constexpr int widest = 1600, largest_panel = 320, most_columns = 8;
constexpr std::size_t most_panels = 40;

std::vector<SheetPanel> chosen(const std::vector<SheetPanel>& panels) {
  if (panels.size() <= most_panels) return panels;
  std::vector<SheetPanel> some;
  some.reserve(most_panels);
  for (std::size_t i = 0; i < most_panels; ++i) some.push_back(panels[i * (panels.size() - 1) / (most_panels - 1)]);
  return some;
}

}  // namespace

std::string fitting_text(const std::string& text, int scale, int width) {
  if (text_width(text, scale) <= width) return text;
  std::string tail = text;
  while (!tail.empty() && text_width("..." + tail, scale) > width) tail.erase(0, 1);
  return "..." + tail;
}

Canvas contact_sheet(const std::vector<SheetPanel>& all, const std::string& title) {
  const std::vector<SheetPanel> panels = chosen(all);
  const int count = std::max<int>(1, static_cast<int>(panels.size()));
  const int rows = (count + most_columns - 1) / most_columns, columns = (count + rows - 1) / rows;
  const int size = std::min(largest_panel, (widest + gap) / columns - gap);
  Canvas sheet(columns * (size + gap) - gap, title_height + rows * (size + caption_height + gap) - gap, {12, 13, 16});
  draw_text(sheet, 10, 10, fitting_text(title, 2, sheet.width - 20), 2, {255, 255, 255});
  double extent = 0.0;
  for (const SheetPanel& panel : panels) extent = std::max(extent, shaded_extent(*panel.mesh));
  std::vector<Canvas> views(panels.size(), Canvas(0, 0));
  parallel_for(panels.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) views[p] = draw_shaded(*panels[p].mesh, size, extent);
  });
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const int column = static_cast<int>(p) % columns, row = static_cast<int>(p) / columns;
    const int left = column * (size + gap), top = title_height + row * (size + caption_height + gap);
    paste(sheet, views[p], left, top);
    const std::string caption = fitting_text(panels[p].caption, 2, size - 4);
    draw_text(sheet, left + (size - text_width(caption, 2)) / 2, top + size + 6, caption, 2, {230, 230, 230});
  }
  return sheet;
}

}  // namespace pellicle
