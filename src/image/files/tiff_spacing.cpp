#include "pellicle/image/files/internal/tiff_spacing.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <pugixml.hpp>
#include <sstream>

#include "pellicle/image/files/internal/text_header.h"

namespace pellicle {
namespace {

bool usable(double length) {
  return std::isfinite(length) && length > 0.0;
}

TiffSpacing from_ome(const pugi::xml_document& document) {
  TiffSpacing result;
  result.source = "OME";
  const pugi::xml_node image = document.document_element().child("Image");
  const pugi::xml_node pixels = image.child("Pixels");
  result.channels = pixels.attribute("SizeC").as_int(1);
  result.frames = pixels.attribute("SizeT").as_int(1);
  result.slices = pixels.attribute("SizeZ").as_int(0);
  result.known = true;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = fmt::format("PhysicalSize{}", "XYZ"[axis]);
    const double stored = pixels.attribute(name.c_str()).as_double(0.0);
    const std::string unit = pixels.attribute((name + "Unit").c_str()).as_string("um");
    const auto mm = mm_per_named_unit(unit);
    if (usable(stored) && mm) {
      result.spacing[axis] = stored * *mm;
      result.unit = unit;
    } else {
      result.known = false;
      result.warnings.push_back(fmt::format(
          "NO SPACING along {} in the OME description: 1 mm is assumed; set it with `spacing`.", "xyz"[axis]));
    }
  }
  return result;
}

TiffSpacing from_imagej(const TiffDescription& description) {
  std::map<std::string, std::string> fields;
  std::istringstream lines(description.text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const auto at = line.find('=');
    if (at != std::string::npos) fields[line.substr(0, at)] = line.substr(at + 1);
  }
  const auto number = [&](const char* key, double otherwise) {
    const auto found = fields.find(key);
    return found == fields.end() ? otherwise : std::strtod(found->second.c_str(), nullptr);
  };
  const auto whole = [&](const char* key, int otherwise) {
    const double value = number(key, otherwise);
    return value >= 1.0 && value < 1e9 ? static_cast<int>(value) : otherwise;
  };
  TiffSpacing result;
  result.source = "ImageJ";
  result.channels = whole("channels", 1);
  result.frames = whole("frames", 1);
  result.slices = whole("slices", whole("images", 0));
  const double z = std::abs(number("spacing", 0.0));
  const bool has_xy = usable(description.x_resolution.value_or(0.0)) && usable(description.y_resolution.value_or(0.0));
  const bool has_z = usable(z);
  const std::string unit = fields.contains("unit") ? fields["unit"] : "";
  const auto mm = mm_per_named_unit(unit);
  if (mm && has_xy) result.spacing.head<2>() << 1.0 / *description.x_resolution, 1.0 / *description.y_resolution;
  if (has_z) result.spacing[2] = z;
  result.known = mm && has_xy && has_z;
  if (mm) {
    result.unit = unit;
    result.spacing *= *mm;
  } else {
    result.warnings.push_back(fmt::format(
        "NO SPACING unit in the ImageJ description: {:.4g} x {:.4g} x {:.4g} mm is assumed; set it with `spacing`.",
        result.spacing[0], result.spacing[1], result.spacing[2]));
    return result;
  }
  if (!has_xy)
    result.warnings.push_back(
        fmt::format("NO SPACING along x and y in the TIFF: 1 {} is assumed; set it with `spacing`.", unit));
  if (!has_z)
    result.warnings.push_back(fmt::format(
        "NO SPACING between slices in the ImageJ description: 1 {} is assumed; set it with `spacing`.", unit));
  return result;
}

}  // namespace

TiffSpacing tiff_spacing(const TiffDescription& description) {
  if (description.text.find("<OME") != std::string::npos) {
    pugi::xml_document document;
    if (document.load_buffer(description.text.data(), description.text.size()) &&
        document.document_element().child("Image").child("Pixels")) {
      return from_ome(document);
    }
  }
  if (description.text.starts_with("ImageJ=")) return from_imagej(description);
  TiffSpacing result;
  result.warnings.emplace_back(
      "NO SPACING in the TIFF (neither ImageJ's nor OME's): 1 mm is assumed; set it with `spacing`.");
  return result;
}

}  // namespace pellicle
