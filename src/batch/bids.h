#pragma once
/// A BIDS dataset in, a BIDS derivatives dataset out (Brain Imaging Data Structure 1.9: derivatives, masks and
/// segmentations). Cases run as those of a batch do.

#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/batch/batch.h"

namespace pellicle {

struct BidsSettings {
  std::filesystem::path program;          ///< as BatchSettings::program
  std::filesystem::path dataset, output;  ///< raw dataset; derivatives dataset, created if missing
  std::vector<std::string> participants;  ///< labels with or without "sub-"; empty: all
  std::vector<std::string> sessions;      ///< labels with or without "ses-"; empty: all
  std::string suffix = "T1w";             ///< of the images that are segmented
  std::string desc = "brain";             ///< of the results: letters and digits
  FlagValues common;                      ///< flags of `segment` for every image
  int jobs = 1, threads = 0;
  bool overwrite = false, keep_going = true;

  /// \throws UsageError.
  void validate() const;
};

/// One image of a dataset.
struct BidsImage {
  std::filesystem::path path;  ///< from the dataset's root: "sub-01/ses-1/anat/sub-01_ses-1_T1w.nii.gz"
  std::string stem;            ///< "sub-01_ses-1_T1w"

  /// Entities without the suffix: "sub-01_ses-1".
  std::string entities() const;
};

/// Sorted by path. \throws NoInput: no dataset, an unknown participant, no image at all.
std::vector<BidsImage> find_bids_images(const BidsSettings& settings);

/// Segments every image into output/pellicle/STEM/ and puts masks (or label maps with their tables) where BIDS wants
/// them, with sidecars; dataset_description.json and README.md. What an earlier run finished under the same flags is
/// kept. \throws as run_batch; CannotCreate when `output` is a dataset of something else.
BatchResult run_bids_participants(const BidsSettings& settings, const BatchContext& context);

/// output/pellicle/report.html over all that is in the dataset. \throws NoInput when there is nothing yet.
std::filesystem::path write_bids_group_page(const BidsSettings& settings, const Observer& observer);

}  // namespace pellicle
