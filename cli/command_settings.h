#pragma once
/// Settings of the commands that have no job of their own in the libraries, and of those that run many cases.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/settings/setting_table.h"

namespace pellicle::cli {

/// `pellicle export`: files made of one saved model. Those that are empty are not written.
struct ExportSettings {
  std::filesystem::path model, mesh, mask, sdf, prob, control;
  std::filesystem::path like;  ///< the volume whose grid voxels lie on
  std::optional<int> density;  ///< 2^N facets along a control edge
  bool overwrite = false;
  int threads = 0;

  /// \throws SettingError. Does not look at any file.
  void validate() const;
  bool writes_voxels() const { return !mask.empty() || !sdf.empty() || !prob.empty(); }
};
const SettingTable<ExportSettings>& export_table();

/// `pellicle info`: what a file holds.
struct InfoSettings {
  std::filesystem::path file;
  std::optional<std::array<double, 3>> spacing;  ///< mm, instead of the file's
  bool json = false;

  void validate() const {}
};
const SettingTable<InfoSettings>& info_table();

/// `pellicle report`: results as one page.
struct ReportSettings {
  std::vector<std::string> results;  ///< folders, or report files
  std::filesystem::path output;
  std::string title;
  std::optional<int> voxels;  ///< edge of the volumes on the page
  bool no_viewer = false, overwrite = false;
  int threads = 0;

  /// \throws SettingError
  void validate() const;
};
const SettingTable<ReportSettings>& report_table();

/// What `batch` and `bids` have in common: several cases at a time.
struct CaseSettings {
  int jobs = 1, threads = 0;
  bool overwrite = false;
};

/// `pellicle batch`.
struct BatchFlags {
  std::vector<std::string> manifest;  ///< one table, or patterns
  std::filesystem::path output;
  std::string shard = "1/1";
  bool resume = false, keep_going = false;
  CaseSettings cases;
};
const SettingTable<BatchFlags>& batch_table();

/// `pellicle bids`.
struct BidsFlags {
  std::filesystem::path dataset, output;
  std::string level;  ///< "participant" or "group"
  std::vector<std::string> participants, sessions;
  std::string suffix = "T1w", desc = "brain";
  CaseSettings cases;
};
const SettingTable<BidsFlags>& bids_table();

}  // namespace pellicle::cli
