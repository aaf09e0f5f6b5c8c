#pragma once
/// Talking to 3D Slicer, which runs programs as modules (docs/slicer.md).

#include <string>
#include <vector>

namespace pellicle::cli {

/// Progress on stdout in the tags that Slicer looks for while a module runs (vtkSlicerCLIModuleLogic.cxx): begins when
/// it is made, ends when it goes, whatever happens in between. Every line is flushed.
class SlicerProgress {
 public:
  explicit SlicerProgress(bool on);
  ~SlicerProgress();
  SlicerProgress(const SlicerProgress&) = delete;
  SlicerProgress& operator=(const SlicerProgress&) = delete;

  /// A line whenever the progress has grown by a hundredth or the step has another name.
  void tell(double fraction, const std::string& what);

 private:
  bool on_;
  int hundredths_ = -1;
  std::string what_;
};

/// Slicer's flags have underscores where ours have dashes: "--seed_radius" becomes "--seed-radius", values stay.
std::vector<std::string> with_dashed_flags(const std::vector<std::string>& words);

}  // namespace pellicle::cli
