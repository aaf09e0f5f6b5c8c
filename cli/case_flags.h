#pragma once
/// What `batch` and `bids` have in common: many cases, each a run of `segment` of its own, several at a time.

#include <string>
#include <vector>

#include "command_flags.h"
#include "pellicle/batch/batch.h"

namespace pellicle::cli {

/// Their own flags, --config, the flags of `segment` that hold for every case, and those of the console.
class CaseFlags {
 public:
  /// Declares them; `*this` must live as long as the app.
  /// \param defaults the values of the command's own default settings.
  /// \param cases what a case is called: "images".
  void declare(CLI::App& app, const std::vector<SettingEntry>& defaults, const std::string& cases);
  /// Sets the command's own settings; sets up the console. \throws SettingError.
  void resolve(const std::vector<SettingTarget>& settings, Console& console) const;
  /// What was given for every case. \throws SettingError.
  FlagValues common() const;
  /// The settings file of all cases; empty: none.
  const std::string& config() const { return config_; }

 private:
  TypedSettings own_, common_, console_;
  std::string config_;
};

/// A line on stdout for each case that ends, a warning for each that failed, and the progress of all.
BatchContext case_lines(Console& console);

}  // namespace pellicle::cli
