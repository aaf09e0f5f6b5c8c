#pragma once
/// Settings of `pellicle morph`: shapes between two saved models.

#include <filesystem>
#include <optional>
#include <string>

#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/settings/setting_table.h"
#include "pellicle/surface/morph.h"

namespace pellicle {

struct MorphSettings {
  std::filesystem::path a, b, output;
  std::string name;  ///< file stem; empty: A_to_B, by the names of the models
  int steps = 5;
  MorphSpace space = MorphSpace::plane;
  double from = 0.0, to = 1.0;  ///< tau of the first and the last step; one step only: the middle between them
  MeshFormat mesh_format = MeshFormat::ply;
  std::optional<int> mesh_density;  ///< 2^N facets along a control edge; default: to look at
  int threads = 0;
  bool overwrite = false;

  /// \throws SettingError with the key, its value and the rule. Does not look at any file.
  void validate() const;
};

const SettingTable<MorphSettings>& morph_table();

}  // namespace pellicle
