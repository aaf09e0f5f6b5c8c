#pragma once
/// Settings of `pellicle phantom`: one object, or a cluster of many, and the image of it.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/settings/setting_table.h"
#include "pellicle/settings/setting_words.h"
#include "pellicle/synthetic/cluster.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle {

template <>
const Words<PhantomFill>& words_of();
template <>
const Words<PhantomNoise>& words_of();

namespace cli {

/// What goes with one kind of phantom alone is set only when it was given.
struct PhantomCommand {
  std::filesystem::path output;
  std::string name;
  bool overwrite = false;
  std::string shape = "sphere";               ///< or "cluster"
  std::optional<std::vector<double>> radius;  ///< mm; of a cluster MIN, MAX
  // Of one object.
  std::optional<std::array<double, 3>> center;  ///< LPS mm
  std::optional<double> amplitude, shell_thickness;
  std::optional<PhantomFill> fill;
  std::optional<int> seeds;
  // Of a cluster.
  std::optional<int> count;
  std::optional<double> distance, elongation;
  std::optional<std::array<double, 2>> contrast_range;
  // Of the image.
  std::array<int, 3> size{96, 96, 96};
  std::array<double, 3> spacing{1, 1, 1}, direction{0, 0, 0};  ///< mm; degrees about x, y, z
  std::array<double, 2> contrast{100, 20};                     ///< intensities inside and outside
  double blur_mm = 1.0;
  PhantomNoise noise = PhantomNoise::gaussian;
  double snr = 5.0, bias = 0.0;
  std::uint64_t seed = 1;
  int threads = 0;

  bool is_cluster() const { return shape == "cluster"; }
  /// \pre not a cluster
  PhantomSettings phantom() const;
  /// \pre a cluster
  ClusterSettings cluster() const;
  /// \throws SettingError
  void validate() const;
};

const SettingTable<PhantomCommand>& phantom_table();

}  // namespace cli
}  // namespace pellicle
