#pragma once
/// What can be measured on an image before anything is fitted, by name: what the preset `auto` is chosen by.

#include <map>
#include <string>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// One measured fact, or one that presets may ask for.
struct FactDescription {
  std::string name, text;
};
/// Every fact that image_facts() gives, in alphabetical order.
const std::vector<FactDescription>& fact_descriptions();

using Facts = std::map<std::string, double>;

/// \param seeded how many objects the user gave seeds for.
/// \param spacing_known whether the file or the user says how large a voxel is.
Facts image_facts(const Image<float>& image, std::size_t seeded, bool spacing_known);

}  // namespace pellicle
